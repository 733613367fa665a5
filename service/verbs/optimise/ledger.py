"""Ledger of the programs of a folder that were optimised: one row each, in a CSV file.

A row is added when everything of its program is written. A row that was broken off by the end
of the process does not count; its program is optimised again.
"""

import csv
import os
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, closing, contextmanager, suppress
from dataclasses import dataclass, fields
from enum import StrEnum
from pathlib import Path

from stepnc_model.errors import StepNcError, WriteError

LEDGER = "advice.csv"


class ProgramStatus(StrEnum):
    """Status of a program."""

    ADVISED = "advised"
    NOTHING = "nothing to advise"
    INFEASIBLE = "infeasible"
    EXCEEDED = "limit exceeded"
    BAD = "bad input"


@dataclass(frozen=True, slots=True, kw_only=True)
class ProgramRow:
    """Row of the ledger."""

    program: str
    """Name of the file."""
    status: ProgramStatus
    workingsteps: int = 0
    advised: int = 0
    """Number of workingsteps with new feeds."""
    time_before_s: float = 0.0
    time_after_s: float = 0.0
    message: str = ""
    """Error, or which workingsteps are infeasible."""
    digest: str = ""
    """Digest of program, request and the files that it names."""


COLUMNS = tuple(each.name for each in fields(ProgramRow))


def known_rows(folder: Path) -> dict[str, ProgramRow]:
    """Rows of the ledger in a folder, by program; none without a ledger.

    Raises
    ------
    StepNcError
        If the file is no ledger.
    """
    place = folder / LEDGER
    try:
        text = place.read_text(encoding="utf-8")
    except FileNotFoundError:
        return {}
    except (OSError, UnicodeDecodeError) as error:
        raise StepNcError(f"{place}: cannot be read: {error}") from error
    whole = text[: text.rfind("\n") + 1]
    lines = csv.reader(whole.splitlines())
    if whole and tuple(next(lines)) != COLUMNS:
        raise StepNcError(f"{place}: is no ledger of `optimise`: its columns must be {COLUMNS}")
    found: dict[str, ProgramRow] = {}
    for line in lines:
        # A row that the end of the machine has damaged is that of a program to do again.
        with suppress(ValueError):
            row = _row(line)
            found[row.program] = row
    return found


def _row(line: list[str]) -> ProgramRow:
    """Row of a line.

    Raises
    ------
    ValueError
        If a cell is missing or no number.
    """
    values = dict(zip(COLUMNS, line, strict=True))
    return ProgramRow(
        program=values["program"],
        status=ProgramStatus(values["status"]),
        workingsteps=int(values["workingsteps"]),
        advised=int(values["advised"]),
        time_before_s=float(values["time_before_s"]),
        time_after_s=float(values["time_after_s"]),
        message=values["message"],
        digest=values["digest"],
    )


class Ledger:
    """Ledger that is being written. Running state.

    Parameters
    ----------
    folder : Path
    kept : iterable of ProgramRow
        Rows with which it begins. The ledger that was there stays until they are written.

    Raises
    ------
    WriteError
        When the disk refuses.
    """

    def __init__(self, folder: Path, kept: Iterable[ProgramRow]) -> None:
        self._place = folder / LEDGER
        begun = self._place.with_name(f".{LEDGER}.begun")
        with self._naming(), ExitStack() as stack:
            self._stream = begun.open("w", encoding="utf-8", newline="")
            stack.callback(begun.unlink, missing_ok=True)
            stack.enter_context(closing(self._stream))
            self._lines = csv.writer(self._stream, lineterminator="\n")
            self._lines.writerow(COLUMNS)
            self._lines.writerows(map(_cells, kept))
            self._stream.flush()
            begun.replace(self._place)
            stack.pop_all()

    def __enter__(self) -> "Ledger":
        return self

    def __exit__(self, *_: object) -> None:
        with suppress(OSError):
            self._stream.close()

    def add(self, row: ProgramRow) -> None:
        """Add a row, and wait until it is on the disk.

        Raises
        ------
        WriteError
            When the disk refuses.
        """
        with self._naming():
            self._lines.writerow(_cells(row))
            self._stream.flush()
            os.fsync(self._stream.fileno())

    @contextmanager
    def _naming(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            raise WriteError(error.strerror or str(error), path=str(self._place)) from error


def _cells(row: ProgramRow) -> list[object]:
    """Cells of a row, each on one line."""
    values = (getattr(row, name) for name in COLUMNS)
    return [" ".join(each.split()) if isinstance(each, str) else each for each in values]
