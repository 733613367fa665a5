"""Deviations from ISO 10303-21, noted while a text is read, within bounds.

A reader that tolerates faults must not be made to describe millions of them. The frame of a
file may have so many and no more; of those within an instance, the first are kept and the
others counted.
"""

from typing import Protocol

from stepnc_model.part21.places import Slip, error_at

MOST_OF_FILE = 10_000
"""deviations outside instances; the worst of the public files read have a dozen"""

MOST_OF_INSTANCE = 100
"""deviations of one instance that are described"""


class Slips(Protocol):
    """Where deviations are noted; a list will do."""

    def append(self, slip: Slip, /) -> None:
        """Note one."""


class FileSlips:
    """Deviations of the frame of a file. Running state; too many of them are an error.

    Parameters
    ----------
    data : bytes
        The file, for the place of the error.
    """

    def __init__(self, data: bytes) -> None:
        self.noted: list[Slip] = []
        self._data = data

    def append(self, slip: Slip, /) -> None:
        """Note one.

        Raises
        ------
        Part21Error
            If there are more than ``MOST_OF_FILE``.
        """
        if len(self.noted) == MOST_OF_FILE:
            message = (
                f"more than {MOST_OF_FILE} deviations from ISO 10303-21: this is no usable "
                f"exchange structure; the last one: {slip.message}"
            )
            raise error_at(self._data, slip.offset, message)
        self.noted.append(slip)


class InstanceSlips:
    """Deviations of one instance. Running state: the first ones, and how many there are."""

    def __init__(self) -> None:
        self.noted: list[Slip] = []
        self.count = 0

    def append(self, slip: Slip, /) -> None:
        """Note one, or count it."""
        self.count += 1
        if self.count <= MOST_OF_INSTANCE:
            self.noted.append(slip)
