"""Exit codes of the command line."""

OK, USAGE, BAD_INPUT, INFEASIBLE, LIMIT_EXCEEDED, NOTHING_ADVISED = 0, 2, 3, 4, 5, 6
"""Exit codes; ``USAGE`` is argparse's; with ``NOTHING_ADVISED`` nothing was written."""
