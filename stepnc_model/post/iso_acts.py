"""What the G codes of ISO 6983 do, by dialect-free names, and the codes most dialects share."""

from enum import Enum, auto

from stepnc_model.post.blocks import RateMode, Sense
from stepnc_model.toolpath.path import CycleKind, Plane


class Act(Enum):
    """What a G code does."""

    NOTHING = auto()
    """says what is so anyway: metric, absolute, zero points, no cutter compensation"""
    RAPID = auto()
    LINEAR = auto()
    CLOCKWISE = auto()
    COUNTERCLOCKWISE = auto()
    THREAD = auto()
    TAP = auto()
    LEFT_TAP = auto()
    TAP_OUT = auto()
    """the way out of a tap, where it is a block of its own"""
    DWELL = auto()
    PLANE_XY = auto()
    PLANE_ZX = auto()
    PLANE_YZ = auto()
    PER_MINUTE = auto()
    PER_REVOLUTION = auto()
    SURFACE_SPEED = auto()
    SPINDLE_SPEED = auto()
    SPEED_LIMIT = auto()
    LENGTH = auto()
    DIAMETER = auto()
    CANCEL = auto()
    TO_RETRACT = auto()
    TO_START = auto()
    DRILL = auto()
    DRILL_DWELL = auto()
    PECK = auto()
    CHIP_BREAK = auto()
    BORE = auto()
    BORE_STOP = auto()


COMMON: dict[str, Act] = {
    "G0": Act.RAPID,
    "G1": Act.LINEAR,
    "G2": Act.CLOCKWISE,
    "G3": Act.COUNTERCLOCKWISE,
    "G4": Act.DWELL,
    "G17": Act.PLANE_XY,
    "G18": Act.PLANE_ZX,
    "G19": Act.PLANE_YZ,
    "G40": Act.NOTHING,
    "G54": Act.NOTHING,
    "G96": Act.SURFACE_SPEED,
    "G97": Act.SPINDLE_SPEED,
}
PER_TIME: dict[str, Act] = {"G94": Act.PER_MINUTE, "G95": Act.PER_REVOLUTION}
CANNED: dict[str, Act] = {
    "G73": Act.CHIP_BREAK,
    "G80": Act.CANCEL,
    "G81": Act.DRILL,
    "G82": Act.DRILL_DWELL,
    "G83": Act.PECK,
    "G85": Act.BORE,
    "G86": Act.BORE_STOP,
    "G98": Act.TO_START,
    "G99": Act.TO_RETRACT,
}
LENGTHS: dict[str, Act] = {
    "G21": Act.NOTHING,
    "G43": Act.LENGTH,
    "G49": Act.NOTHING,
    "G90": Act.NOTHING,
}

PLANES = {Act.PLANE_XY: Plane.XY, Act.PLANE_ZX: Plane.ZX, Act.PLANE_YZ: Plane.YZ}
MODES = {Act.PER_MINUTE: RateMode.PER_MINUTE, Act.PER_REVOLUTION: RateMode.PER_REVOLUTION}
KINDS = {
    Act.DRILL: CycleKind.DRILL,
    Act.DRILL_DWELL: CycleKind.DWELL,
    Act.PECK: CycleKind.PECK,
    Act.CHIP_BREAK: CycleKind.CHIP_BREAK,
    Act.BORE: CycleKind.BORE,
    Act.BORE_STOP: CycleKind.BORE_STOP,
}
MOTIONS = frozenset({
    Act.RAPID,
    Act.LINEAR,
    Act.CLOCKWISE,
    Act.COUNTERCLOCKWISE,
    Act.THREAD,
    Act.TAP,
    Act.LEFT_TAP,
    Act.TAP_OUT,
    *KINDS,
})
TAPS = frozenset({Act.TAP, Act.LEFT_TAP, Act.TAP_OUT})
SENSES = {"M3": Sense.CLOCKWISE, "M4": Sense.COUNTERCLOCKWISE}
