"""One self-contained HTML page for a plan."""

from optimiser.advice import Plan


def report_page(plan: Plan) -> str:
    """The page."""
    return f"<html><body>{plan.program}</body></html>"
