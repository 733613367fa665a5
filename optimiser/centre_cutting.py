"""Whether a mill may go straight down into the solid: its edges must reach its axis.

A cutter whose edges end short of the axis leaves a core that its face presses on. ISO 14649-111
has no attribute for it, so a tool table says it; of some bodies their form does.
"""

from optimiser.conditions import Conditions
from optimiser.cut import Cut
from stepnc_model.errors import Finding, Severity
from stepnc_model.program import Program, Workingstep

RAMPS = "plunge_ramp, plunge_helix or plunge_zigzag"


def goes_into_solid(cut: Cut | None) -> bool:
    """Whether material under the axis of a mill is met straight down."""
    if cut is None:
        return False
    return cut.plunge is not None or (cut.way_in is not None and cut.way_in.reaches_axis)


def plunge_fault(cut: Cut | None, at: Conditions, *, is_allowed: bool) -> str:
    """Why a cut may not go straight down as it does; empty where it may."""
    if is_allowed or at.centre_cutting is not False or not goes_into_solid(cut):
        return ""
    return "goes straight down into the solid with a tool that does not cut over centre"


def plunge_findings(
    program: Program, step: Workingstep, cut: Cut | None, at: Conditions, *, is_allowed: bool
) -> list[Finding]:
    """What is said of a plunge into the solid: of an unknown tool always in the same words."""
    if cut is None or not goes_into_solid(cut):
        return []
    tool = f"tool '{cut.tool.id}'"
    if at.centre_cutting is None:
        text = (
            f"{tool} goes straight down into the solid, and nothing says whether it cuts over "
            f"centre: a ramp ({RAMPS}) spares it, centre_cutting in a tool table settles it"
        )
        return [program.finding(Severity.WARNING, text, step.tool_ref)]
    if at.centre_cutting:
        return []
    severity = Severity.WARNING if is_allowed else Severity.ERROR
    text = f"{tool} does not cut over centre and goes straight down into the solid: take a ramp"
    return [program.finding(severity, f"{text} ({RAMPS})", step.operation_ref, "approach")]
