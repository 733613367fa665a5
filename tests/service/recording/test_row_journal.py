"""Rows of a recording survive whatever ends it."""

import signal
import subprocess
import sys
from functools import partial
from itertools import count
from pathlib import Path

import pytest
from pyarrow import csv, parquet

from service.outputs.run_file import ColumnKind, RunColumn
from service.recording.request import RecordingRequest
from service.recording.run import RowJournal, record
from stepnc_model.errors import WriteError
from tests.extras.agent.test_run import run_of, served
from tests.service.cli.command import START
from tests.service.waiting import ROOT, ended, environment, until

COLUMNS = (RunColumn(name="time_s", kind=ColumnKind.EXACT),)
SIGNALS = (signal.SIGTERM, signal.SIGHUP, signal.SIGKILL)


def lines(place: Path) -> int:
    """Whole lines of a journal below its heading."""
    return place.read_bytes().count(b"\n") - 1 if place.exists() else 0


def some_lines(place: Path) -> int | None:
    """Their number, once there are some."""
    found = lines(place)
    return found if found > 10 else None


def test_rows_survive_whatever_signal_ends_a_recording(tmp_path: Path) -> None:
    """They do it at the same time, as starting them is what takes long."""
    request, run = run_of("paper000", "paper000", speed=5.0)
    names = {number: tmp_path / f"{number.name}.parquet" for number in SIGNALS}
    with served(request, run) as url:
        programs = {
            number: subprocess.Popen(
                [sys.executable, "-c", START, "record", url, "-o", str(output)],
                cwd=ROOT, env=environment(tmp_path), stderr=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
            )
            for number, output in names.items()
        }  # fmt: skip
        seen = {}
        for number, output in names.items():
            journal = output.with_suffix(".partial.csv")
            seen[number] = until(partial(some_lines, journal))
            programs[number].send_signal(number)
        codes = {number: ended(program) for number, program in programs.items()}
    assert codes == dict.fromkeys(SIGNALS, 0) | {signal.SIGKILL: -9}
    killed = names.pop(signal.SIGKILL)
    assert not killed.exists()
    assert csv.read_csv(killed.with_suffix(".partial.csv")).num_rows >= seen[signal.SIGKILL]
    for number, output in names.items():
        assert parquet.read_metadata(output).num_rows >= seen[number]
        assert not output.with_suffix(".partial.csv").exists()


def test_announced_rows_are_on_the_disk(tmp_path: Path) -> None:
    """A clock that jumps makes it tell its progress after each part."""
    output, told = tmp_path / "run.csv", []
    journal = tmp_path / "run.partial.csv"

    def tell(text: str) -> None:
        number, _, what = text.partition(" ")
        if what == "rows":
            told.append((int(number), lines(journal)))

    request, run = run_of("paper000", "paper000", speed=5.0)
    clock = count(step=10.0)
    with served(request, run) as url:
        wanted = RecordingRequest(duration_s=100.0)
        record(url, output, wanted, tell=tell, clock=lambda: next(clock))
    assert told
    assert [number for number, _ in told] == [kept for _, kept in told]
    assert list(tmp_path.iterdir()) == [output]


def test_rows_of_an_earlier_recording_stay(tmp_path: Path) -> None:
    output = tmp_path / "run.parquet"
    first, second = RowJournal(output, COLUMNS), RowJournal(output, COLUMNS)
    first.write([[1.0]])
    second.write([[2.0]])
    second.remove()
    first.close()
    assert [each.name for each in tmp_path.iterdir()] == ["run.partial.csv"]
    assert csv.read_csv(first.place).to_pydict() == {"time_s": [1.0]}


def test_a_disk_that_refuses_is_named() -> None:
    with pytest.raises(WriteError, match=r"run\.parquet"):
        RowJournal(Path("/nowhere/run.parquet"), COLUMNS)
