"""Names of the models of how a control runs a path."""

from enum import StrEnum


class ControlModelName(StrEnum):
    """Name of a control model."""

    EXACT_STOP = "exact-stop"
    """each block from rest to rest"""
    JUNCTION = "junction"
    """continuous, corners at the speed of a junction deviation"""
    FIR = "fir"
    """axis commands filtered over fixed times"""
