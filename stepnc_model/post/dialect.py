"""Names of the controls for which NC code is written and read."""

from enum import StrEnum


class Dialect(StrEnum):
    """Dialects of NC code."""

    CANONICAL = "canonical"
    """canonical machining commands, which no control runs and all can be compared by"""
    LINUXCNC = "linuxcnc"
    FANUC = "fanuc"
    HAAS = "haas"
    SINUMERIK = "sinumerik"
    """840D"""
    HEIDENHAIN = "heidenhain"
    """Klartext, mills only"""

    @property
    def suffix(self) -> str:
        """Ending of its files."""
        return SUFFIXES[self]


SUFFIXES = {
    Dialect.CANONICAL: ".canonical.txt",
    Dialect.LINUXCNC: ".ngc",
    Dialect.FANUC: ".nc",
    Dialect.HAAS: ".nc",
    Dialect.SINUMERIK: ".mpf",
    Dialect.HEIDENHAIN: ".h",
}
