"""Request of ``materials``."""

from dataclasses import dataclass

from service.requests.fields import Request
from service.requests.files import EntryName


@dataclass(frozen=True, slots=True, kw_only=True)
class MaterialsRequest(Request):
    """Request of the materials of the library: it has no values."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MaterialsFiles(Request):
    """Names of ``materials``."""

    name: EntryName = None


REQUEST, FILES = MaterialsRequest, MaterialsFiles
