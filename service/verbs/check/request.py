"""Request of ``check``."""

from dataclasses import dataclass
from typing import Annotated

from service.requests.fields import About, Request
from service.requests.files import CodeControl, KeepsState, MostRepeats, NamedTools, ProgramFile
from service.requests.program_facts import Name, ProgramRequest


@dataclass(frozen=True, slots=True, kw_only=True)
class CheckRequest(ProgramRequest):
    """Request to check a program."""

    dialect: CodeControl = None


@dataclass(frozen=True, slots=True, kw_only=True)
class CheckFiles(Request):
    """Files of ``check``."""

    file: ProgramFile
    tools: NamedTools = None
    name: Annotated[Name, About("name of the program in messages; empty: that of its file")] = (
        ""
    )
    most_repeats: MostRepeats = None
    keeps_state: KeepsState = ()


REQUEST, FILES = CheckRequest, CheckFiles
