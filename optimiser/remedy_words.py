"""What would help against each limit, in words."""

from collections.abc import Iterable

from optimiser.problem import LimitName

STIFFER = "a thicker tool or a shorter overhang"

REMEDIES: dict[str, str] = {
    LimitName.TOOL_DEFLECTION: f"{STIFFER}, or an allowance for a finishing pass",
    LimitName.SHANK_STRENGTH: f"{STIFFER}, or a smaller radial width",
    LimitName.STABILITY: f"{STIFFER}, or another spindle speed (--free feed,depth,speed)",
    LimitName.MOTOR_POWER: "a stronger spindle, or a smaller radial width",
    LimitName.SPINDLE_TORQUE: "a stronger spindle, or a thinner tool",
    LimitName.CUTTING_FORCE: "a stronger machine, or a thinner tool",
    LimitName.FEED_PER_TOOTH: "more teeth, or a tool with a higher catalogue feed",
    LimitName.PROGRAMMED_FEED: "a catalogue feed for this tool and material",
    LimitName.FEED_MECHANISM: "a machine with faster feed drives",
    LimitName.CUTTING_SPEED: "a cutting material for a higher speed",
    LimitName.SPINDLE_SPEED: "a machine or chuck for a higher speed",
    LimitName.AXIAL_DEPTH: "longer cutting edges",
    LimitName.ROUGHNESS: "a larger corner radius, or a wiper",
    LimitName.CHUCK_TORQUE: "a greater clamping force",
    LimitName.TILTING_MOMENT: "a greater clamping force, or a shorter overhang of the bar",
    LimitName.HOLDING_FORCE: "a greater clamping force",
    LimitName.BAR_DEFLECTION: "a tailstock, or a shorter overhang of the bar",
}
"""Change of tool, machine, clamping or drawing that widens a limit."""


def remedy_for(limits: Iterable[str]) -> str:
    """End of a sentence that names what would help against limits; empty where unknown."""
    words = dict.fromkeys(REMEDIES[each] for each in limits if each in REMEDIES)
    return f"; {', or '.join(words)} would help" if words else ""
