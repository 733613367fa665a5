"""Advice for a folder: a row for each program."""

from dataclasses import dataclass

from service.errors import BAD_INPUT, INFEASIBLE, LIMIT_EXCEEDED, OK
from service.rendering.columns import Change, Column
from service.rendering.view import Fact, ResultView, Table, TextLine
from service.verbs.optimise.ledger import ProgramRow, ProgramStatus
from service.verbs.optimise.result import OptimiseResult

ROWS: tuple[Column[ProgramRow], ...] = (
    Column(key="program", heading="program", is_key=True, kind=str,
           value=lambda row: row.program),
    Column(key="status", heading="status", kind=str, value=lambda row: row.status.value),
    Column(key="workingsteps", heading="workingsteps", form="d", is_right=True,
           value=lambda row: row.workingsteps),
    Column(key="advised", heading="advised", form="d", is_right=True,
           value=lambda row: row.advised),
    Column(key="time_before_s", value=lambda row: row.time_before_s),
    Column(key="time_after_s", value=lambda row: row.time_after_s),
    Column(heading="time s", form=".1f", is_right=True,
           value=lambda row: Change(before=row.time_before_s, after=row.time_after_s)),
    Column(key="message", value=lambda row: row.message),
)  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class FolderAdvice(OptimiseResult):
    """Results of the programs of a folder."""

    rows: tuple[ProgramRow, ...]
    """By name."""
    made: int
    """Number of programs that were optimised in this run; others had been before."""

    def has(self, status: ProgramStatus) -> bool:
        """True if a program has a status."""
        return any(row.status is status for row in self.rows)

    @property
    def time_before(self) -> float:
        """Time of all programs as given, s."""
        return sum(row.time_before_s for row in self.rows)

    @property
    def time_after(self) -> float:
        """Time of all advised programs, s."""
        return sum(row.time_after_s for row in self.rows)

    @property
    def exit_code(self) -> int:
        """Exit code of the worst program."""
        for status, code in (
            (ProgramStatus.BAD, BAD_INPUT),
            (ProgramStatus.INFEASIBLE, INFEASIBLE),
            (ProgramStatus.EXCEEDED, LIMIT_EXCEEDED),
        ):
            if self.has(status):
                return code
        return OK

    def view(self) -> ResultView:
        """Return a row for each program, then what was wrong."""
        total = f"{self.time_before:.1f} -> {self.time_after:.1f}"
        known = len(self.rows) - self.made
        text = f"{known} of the programs had been optimised before, with the same options"
        return ResultView([
            Table(key="programs", columns=ROWS, rows=self.rows,
                  foot={"program": "total", "time s": total}),
            *(
                TextLine(text=f"  {row.program}: {row.message}")
                for row in self.rows
                if row.message
            ),
            *([TextLine(text=text)] if known else []),
            Fact(key="made", value=self.made),
        ])  # fmt: skip
