"""Number style of a program, so that new numbers look and count alike."""

import re
from dataclasses import dataclass
from decimal import ROUND_FLOOR, ROUND_HALF_EVEN, Decimal

from stepnc_model.nc.moves import FeedMode
from stepnc_model.nc.text import NcText
from stepnc_model.post.dialect import Dialect

LOOKED_AT = 1 << 22
"""Bytes at the beginning of a file whose numbers are looked at."""

COORDINATE = re.compile(rb"[XYZIJKUW][ \t]*=?[ \t]*[-+]?[0-9]*\.([0-9]*)", re.I)
FEED = re.compile(rb"F[ \t]*=?[ \t]*[0-9]+(\.?)([0-9]*)", re.I)
SPACED = re.compile(rb"[0-9.][ \t]+[XYZF][-+0-9.]", re.I)
NEWLINE = re.compile(rb"\r\n|\n|\r")

LEAST_PLACES = {Dialect.LINUXCNC: 4}
"""Least number of decimal places of a coordinate in mm; 3 for other controls."""

FINE_FEED = {FeedMode.PER_REVOLUTION: 4, FeedMode.INVERSE_TIME: 4}
"""Least number of decimal places of a feed by mode."""

SURPLUS = Decimal("1e-9")
"""Relative excess by which a feed may seem to exceed its number, from binary fractions."""


@dataclass(frozen=True, slots=True, kw_only=True)
class NumberStyle:
    """Style of the numbers of one program."""

    places: int
    """Decimal places of coordinates in units of the program."""
    feed_places: int
    """Decimal places of feeds per minute."""
    is_pointed: bool
    """Whether whole numbers end with a decimal point."""
    is_feed_pointed: bool
    is_signed: bool
    """Whether positive coordinates carry a plus sign."""
    is_fixed: bool
    """Whether coordinates keep trailing zeros."""
    gap: str
    """Text between two words."""
    newline: str

    def coordinate(self, value: Decimal) -> str:
        """Text of a coordinate that is already rounded."""
        text = f"{value:.{self.places}f}"
        if not self.is_fixed and "." in text:
            text = text.rstrip("0").rstrip(".")
        text = "0" if text in {"-0", ""} else text
        if self.is_pointed and "." not in text:
            text += "."
        return f"+{text}" if self.is_signed and not text.startswith("-") else text

    def rounded(self, value: float) -> Decimal:
        """Coordinate rounded to the resolution of the program."""
        step = Decimal(1).scaleb(-self.places)
        return Decimal(value).quantize(step, rounding=ROUND_HALF_EVEN) + 0

    def feed(self, value: float, mode: FeedMode) -> str:
        """Text of a feed, rounded down; ``0`` if it is below the resolution."""
        places = max(self.feed_places, FINE_FEED.get(mode, 0))
        if mode is FeedMode.PER_MINUTE:
            places = max(places, _feed_places(value))
        exact = Decimal(value)
        step = Decimal(1).scaleb(-places)
        number = (exact + exact * SURPLUS).quantize(step, rounding=ROUND_FLOOR)
        text = f"{number:f}"
        if "." in text:
            text = text.rstrip("0").rstrip(".")
        return text + "." if self.is_feed_pointed and "." not in text else text


def _feed_places(value: float) -> int:
    """Decimal places of a feed per minute of which rounding takes at most 1 %."""
    if value >= 100.0:
        return 0 if value >= 1000.0 else 1
    if value >= 1.0:
        return 2
    return 3 if value >= 0.1 else 4


def style_of(text: NcText, dialect: Dialect, *, unit: float) -> NumberStyle:
    """Find the style of the numbers of a program.

    Parameters
    ----------
    text : NcText
    dialect : Dialect
    unit : float, mm
        Length of one unit of the program.
    """
    head = text.data[:LOOKED_AT]
    decimals = [found[1] for found in COORDINATE.finditer(head)]
    feeds = [(found[1], found[2]) for found in FEED.finditer(head)]
    least = 4 if unit > 1.0 else LEAST_PLACES.get(dialect, 3)
    newline = NEWLINE.search(head)
    is_klartext = dialect is Dialect.HEIDENHAIN
    is_old = dialect in {Dialect.FANUC, Dialect.HAAS}
    # Old controls may count a feed without a point in less than whole units.
    pointed_feeds = any(point and (is_old or not digits) for point, digits in feeds)
    return NumberStyle(
        places=min(6, max(least, *map(len, decimals), 0)),
        feed_places=min(4, max((len(digits) for _, digits in feeds), default=0)),
        is_pointed=any(not digits for digits in decimals) or (is_old and not decimals),
        is_feed_pointed=pointed_feeds or (is_old and not feeds),
        is_signed=is_klartext,
        is_fixed=_is_fixed(decimals),
        gap=" " if is_klartext or dialect is Dialect.SINUMERIK or SPACED.search(head) else "",
        newline="\n" if newline is None else newline[0].decode("ascii"),
    )


def _is_fixed(decimals: list[bytes]) -> bool:
    """True if all numbers have the same decimal places, trailing zeros included."""
    lengths = set(map(len, decimals))
    return len(lengths) == 1 and lengths != {0} and any(d.endswith(b"0") for d in decimals)
