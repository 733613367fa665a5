"""Reference loads: taught once, kept beside the tool, compared with by later runs."""

import csv
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from controller.monitoring.tool_life import new_tool
from service.control.cuts import COLUMNS, cuts, cuts_csv, taught_by
from service.control.loads import CutKey, ReferenceLoad, read_loads, taught_load, write_loads
from service.control.record import control_recorded
from service.control.run import ControlRun
from stepnc_model.errors import StepNcError
from tests.asking import AskedControl
from tests.every_case import every_case

Controlled = Callable[..., AskedControl]

LOAD = ReferenceLoad(force_n=400.0, power_w=900.0, kc_factor=1.1, revolutions=300)
KEYS = [CutKey("vmc15", "c45", "mill", name) for name in ("ROUGH", "FINISH")]


def test_what_is_written_is_read(tmp_path: Path) -> None:
    path = tmp_path / "loads.json"
    assert read_loads(path) == read_loads(None) == {}
    write_loads(path, dict.fromkeys(KEYS, LOAD))
    first = path.read_bytes()
    assert read_loads(path) == dict.fromkeys(KEYS, LOAD)
    write_loads(path, dict.fromkeys(reversed(KEYS), LOAD))
    assert path.read_bytes() == first


@every_case(
    ("text", "words"),
    [
        ("", "it holds no reference loads"),
        ("[]", "it holds no reference loads"),
        ('{"reference_loads": {}}', "must be a list"),
        ('{"reference_loads": [3]}', "reference load 1"),
        ('{"reference_loads": [{}]}', "'machine' is missing"),
    ],
)
def test_another_file_is_refused(text: str, words: str, tmp_path: Path) -> None:
    path = tmp_path / "loads.json"
    path.write_text(text)
    with pytest.raises(StepNcError, match=words):
        read_loads(path)


@every_case(
    ("change", "words"),
    [
        ({"force_n": 0.0}, "force_n 0.0 must be positive"),
        ({"kc_factor": float("nan")}, "kc_factor nan must be positive"),
        ({"force_n": "400"}, "loads must be numbers"),
        ({"tool": 7}, "must be text"),
        ({"revolutions": 0}, "revolutions at least 1"),
    ],
)
def test_an_entry_that_cannot_be_is_named(
    change: dict[str, object], words: str, tmp_path: Path
) -> None:
    path = tmp_path / "loads.json"
    write_loads(path, dict.fromkeys(KEYS, LOAD))
    entries = json.loads(path.read_text())
    entries["reference_loads"][1] |= change
    path.write_text(json.dumps(entries))
    with pytest.raises(StepNcError, match=f"reference load 2: .*{words}"):
        read_loads(path)


def test_a_first_run_teaches_and_the_next_one_is_compared(
    controlled: Controlled, tmp_path: Path
) -> None:
    path, log = tmp_path / "loads.json", tmp_path / "cuts.csv"
    request, files = controlled(loads=path, cut_log=log)
    first = control_recorded(request, files)
    taught = read_loads(path)
    assert list(taught) == [cut.key for cut in cuts(first)]
    assert all(load.kc_factor == pytest.approx(1.0, abs=0.05) for load in taught.values())
    harder = controlled(loads=path, cut_log=log, disturbances=("kc:1.2",))
    second = control_recorded(*harder)
    assert read_loads(path) == taught
    with log.open(newline="") as file:
        (row,) = csv.DictReader(file)
    (cut,) = cuts(second)
    assert list(row) == [column.key for column in COLUMNS]
    (load,) = taught.values()
    assert float(row["reference_force_n"]) == pytest.approx(load.force_n, rel=1e-5)
    assert float(row["load_percent_of_reference"]) == pytest.approx(cut.load_percent, rel=1e-4)
    life = cut.record.life
    assert life is not None
    # Harder work than was taught is not a worn tool.
    assert life.flank_wear < 0.15
    assert not life.is_worn_out


def test_teaching_without_a_file_is_refused(controlled: Controlled) -> None:
    with pytest.raises(StepNcError, match="--teach needs a file"):
        control_recorded(*controlled(is_teaching=True))


def test_loads_are_taught_anew_only_when_asked(control_run: ControlRun) -> None:
    (key,) = taught_by(control_run, is_teaching=False)
    known = _with_loads(control_run, {key: LOAD})
    assert taught_by(known, is_teaching=False) == {}
    assert list(taught_by(known, is_teaching=True)) == [key]
    assert taught_by(_stopped(control_run), is_teaching=True) == {}


def test_a_worn_tool_teaches_nothing(control_run: ControlRun) -> None:
    (cut,) = cuts(control_run)
    assert taught_load(cut.record) is not None
    assert taught_load(replace(cut.record, life=new_tool(0.1))) is None


def test_equal_runs_have_equal_logs(control_run: ControlRun) -> None:
    assert cuts_csv(control_run) == cuts_csv(control_run)
    assert cuts_csv(control_run).count(b"\n") == 1 + len(cuts(control_run))


def _with_loads(run: ControlRun, loads: dict[CutKey, ReferenceLoad]) -> ControlRun:
    return replace(run, loads=loads)


def _stopped(run: ControlRun) -> ControlRun:
    return replace(run, is_stopped=True)
