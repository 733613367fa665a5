"""Result of ``validate``: that of a table of cuts."""

from extras.calibration.verbs.calibrate.cuts import CutsResult

__all__ = ["CutsResult"]
