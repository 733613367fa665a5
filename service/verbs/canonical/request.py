"""Request of ``canonical``."""

from dataclasses import dataclass
from typing import Annotated

from service.requests.fields import About, Request
from service.requests.files import KeepsGoing, NamedTools, ProgramFile
from service.requests.program_facts import ProgramRequest
from stepnc_model.post.dialect import Dialect


@dataclass(frozen=True, slots=True, kw_only=True)
class CanonicalRequest(ProgramRequest):
    """Request to show a program as canonical commands."""

    dialect: Annotated[
        Dialect | None,
        About(
            "control of NC code: linuxcnc, fanuc, haas, sinumerik, heidenhain or canonical "
            "(default: guessed from the code)",
            name="control", flag="--control", metavar="NAME",
        ),
    ] = None  # fmt: skip
    is_lathe: Annotated[bool, About("Fanuc or Haas code for a lathe", flag="--lathe")] = False
    keep_going: KeepsGoing = False


@dataclass(frozen=True, slots=True, kw_only=True)
class CanonicalFiles(Request):
    """Files of ``canonical``."""

    file: ProgramFile
    tools: NamedTools = None


REQUEST, FILES = CanonicalRequest, CanonicalFiles
