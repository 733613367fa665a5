"""Result of ``validate``: that of a table of cuts."""

from service.verbs.calibrate.cuts import CutsResult

__all__ = ["CutsResult"]
