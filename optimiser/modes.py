"""Definitions of the modes time-critical, quality-critical and energy-critical.

TC
    Least machining time. A roughness stated for the surface is kept.
QC
    The fastest feed that keeps the roughness asked for, never below the minimum chip
    thickness. (Least roughness alone would be least feed, which rubs.)
EC
    Least energy: what the machine draws while it cuts, and the cut itself.

TC and QC are the modes of F. Ridwan, X. Xu, G. Liu, "A framework for machining optimisation
based on STEP-NC", J. Intell. Manuf. 23 (2012) 423–441, eqs. (12)–(14), in their corrected
form; see ``docs/models.md``.
"""

from enum import StrEnum


class Mode(StrEnum):
    """Objective of the optimisation."""

    TC = "TC"
    QC = "QC"
    EC = "EC"


class Free(StrEnum):
    """Variables that the optimiser may change."""

    FEED = "feed"
    DEPTH = "depth"
    SPEED = "speed"
