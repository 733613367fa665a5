"""Motions, feed modes and functions of single blocks that G codes of ISO code ask for."""

from enum import Enum, auto

from stepnc_model.nc.moves import FeedMode


class ModalMotion(Enum):
    """Modal motion that axis words execute."""

    RAPID = auto()
    LINE = auto()
    CLOCKWISE = auto()
    COUNTERCLOCKWISE = auto()
    THREAD = auto()
    TAP = auto()
    """Into a hole and out again, synchronised with the spindle."""


class Shot(Enum):
    """Function of one block that uses the axis words for something else than a move."""

    DWELL = auto()
    HOME = auto()
    MACHINE = auto()
    SHIFT = auto()
    LOCAL = auto()
    OFFSETS = auto()
    CENTRE = auto()
    """Axis words name the centre of a rotation, scale or mirror image."""


MOTIONS = {
    0: ModalMotion.RAPID,
    10: ModalMotion.LINE,
    20: ModalMotion.CLOCKWISE,
    30: ModalMotion.COUNTERCLOCKWISE,
    330: ModalMotion.THREAD,
}
MODES = {
    930: FeedMode.INVERSE_TIME,
    940: FeedMode.PER_MINUTE,
    950: FeedMode.PER_REVOLUTION,
}
SHOTS = {
    40: Shot.DWELL,
    280: Shot.HOME,
    300: Shot.HOME,
    530: Shot.MACHINE,
    920: Shot.SHIFT,
    520: Shot.LOCAL,
    100: Shot.OFFSETS,
}
