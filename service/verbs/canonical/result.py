"""Result of ``canonical``: the commands."""

from dataclasses import dataclass

from service.errors import BAD_INPUT, OK
from service.rendering.columns import Column
from service.rendering.view import Fact, ResultView, Table, TextLine
from service.verbs.result import Result
from stepnc_model.errors import SchemaError
from stepnc_model.post.canonical import Canonical
from stepnc_model.post.dialect import Dialect

COMMANDS: tuple[Column[Canonical], ...] = (
    Column(key="name", value=lambda command: command.name, kind=str),
    Column(key="arguments", value=lambda command: list(command.arguments)),
)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CanonicalResult(Result):
    """Canonical commands of a program."""

    name: str
    control: Dialect | None
    """Control of NC code; None for a STEP-NC program."""
    commands: tuple[Canonical, ...]
    faults: tuple[SchemaError, ...] = ()
    """Reasons why some executables were left out."""

    @property
    def exit_code(self) -> int:
        """Exit code of the command line; bad input if a workingstep was left out."""
        return BAD_INPUT if self.faults else OK

    def view(self) -> ResultView:
        """Return a line for each command."""
        return ResultView([
            Fact(key="program", value=self.name),
            Fact(key="control", value=None if self.control is None else self.control.value),
            Table(key="commands", columns=COMMANDS, rows=self.commands, is_shown=False),
            Fact(key="left_out", value=[str(fault) for fault in self.faults]),
            *(TextLine(text=str(command)) for command in self.commands),
        ])
