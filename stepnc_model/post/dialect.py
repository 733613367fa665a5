"""Controls for which NC code is written and read."""

from enum import StrEnum


class Dialect(StrEnum):
    """Dialects of NC code."""

    CANONICAL = "canonical"
    """Canonical machining commands, which no control runs; all dialects compare to them."""
    LINUXCNC = "linuxcnc"
    FANUC = "fanuc"
    HAAS = "haas"
    SINUMERIK = "sinumerik"
    """Siemens Sinumerik 840D."""
    HEIDENHAIN = "heidenhain"
    """Heidenhain Klartext, mills only."""

    @property
    def suffix(self) -> str:
        """File name extension of the dialect."""
        return SUFFIXES[self]


SUFFIXES = {
    Dialect.CANONICAL: ".canonical.txt",
    Dialect.LINUXCNC: ".ngc",
    Dialect.FANUC: ".nc",
    Dialect.HAAS: ".nc",
    Dialect.SINUMERIK: ".mpf",
    Dialect.HEIDENHAIN: ".h",
}
