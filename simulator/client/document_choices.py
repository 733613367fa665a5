"""Choices of an MTConnect document: its schema version, and the ids of its data items."""

from dataclasses import dataclass
from enum import StrEnum


class SchemaVersion(StrEnum):
    """Schema version of documents."""

    V1_3 = "1.3"
    V2_0 = "2.0"
    V2_7 = "2.7"

    @property
    def key(self) -> tuple[int, int]:
        """Number by which versions are ordered."""
        major, minor = map(int, self.value.split("."))
        return major, minor


class NameSet(StrEnum):
    """Ids of data items."""

    MODERN = "modern"
    """short ids after the device"""
    PAPERS = "papers"
    """as printed in the papers on the virtual machine, where they have one"""


@dataclass(frozen=True, slots=True, kw_only=True)
class DocumentChoice:
    """Form of a document of MTConnect."""

    version: SchemaVersion = SchemaVersion.V2_7
    names: NameSet = NameSet.MODERN
    part: str = ""
    """Id of the part; empty: unknown."""
    batch: str = ""
