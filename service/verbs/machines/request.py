"""Request of ``machines``."""

from dataclasses import dataclass

from service.requests.fields import Request
from service.requests.files import EntryName


@dataclass(frozen=True, slots=True, kw_only=True)
class MachinesRequest(Request):
    """Request of the machines of the library: it has no values."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MachinesFiles(Request):
    """Names of ``machines``."""

    name: EntryName = None


REQUEST, FILES = MachinesRequest, MachinesFiles
