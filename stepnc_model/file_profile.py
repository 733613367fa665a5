"""How optimisation records are written into a program."""

from enum import StrEnum


class FileProfile(StrEnum):
    """File profile: the entities that hold the record."""

    OPTIMISATION = "optimisation"
    STANDARD = "standard"
