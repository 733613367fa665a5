"""Forms in which optimisation records are written into a program."""

from enum import StrEnum


class FileProfile(StrEnum):
    """File profile, the form in which an optimisation record is written."""

    OPTIMISATION = "optimisation"
    STANDARD = "standard"


class RecordChoice(StrEnum):
    """Choice whether optimisation records are written at all."""

    ALL = "all"
    NONE = "none"
