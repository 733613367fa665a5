"""Names of the models of how a control runs a path."""

from enum import StrEnum


class ControlModelName(StrEnum):
    """Name of a control model."""

    EXACT_STOP = "exact-stop"
    """Each block runs from rest to rest."""
    JUNCTION = "junction"
    """Continuous path; corner speeds follow from a junction deviation."""
    FIR = "fir"
    """Axis commands filtered with fixed times."""
    LINUXCNC = "linuxcnc"
    """LinuxCNC's planner: corners rounded within the path tolerance of the program."""
