"""Optimisation modes: time-, quality-, energy- and cost-critical (TC, QC, EC, CC).

TC
    Least machining time. A roughness stated for the surface is kept.
QC
    The fastest feed that keeps the required roughness, never below the minimum chip
    thickness. (Least roughness alone would mean least feed, which rubs.)
EC
    Least energy, of the machine and of the cut itself.
CC
    Least cost: machine rate times time, worn edges and their changes.

TC and QC are the modes of F. Ridwan, X. Xu, G. Liu, "A framework for machining optimisation
based on STEP-NC", J. Intell. Manuf. 23 (2012) 423–441, eqs. (12)–(14), in their corrected
form; see ``docs/models.md``.
"""

from enum import StrEnum


class Mode(StrEnum):
    """Objective of the feed optimisation."""

    TC = "TC"
    QC = "QC"
    EC = "EC"
    CC = "CC"


class Free(StrEnum):
    """Variables that the optimiser may change."""

    FEED = "feed"
    DEPTH = "depth"
    SPEED = "speed"
