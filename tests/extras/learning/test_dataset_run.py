"""Data sets: rows are runs, made once, resumed and extended without a difference."""

import json
import os
import subprocess
import sys
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from dataclasses import asdict
from multiprocessing import get_context
from pathlib import Path
from signal import SIGKILL
from typing import Any

import pyarrow as pa
import pytest
from pyarrow import csv, parquet

from extras.factory.cycles import part_cycle
from extras.factory.model.design_file import read_design
from extras.learning.dataset_folder import DatasetFolder
from extras.learning.dataset_run import (
    DatasetFiles,
    DatasetResult,
    dataset_source,
    make_dataset,
)
from service.programs.machine_choice import material_for
from service.progress import silent
from simulator.library import load_machine
from stepnc_model.editing.cut_settings import CutSettings
from stepnc_model.errors import StepNcError
from stepnc_model.programs.program import Program
from stepnc_model.units import rev_s_from_rad_s
from tests.every_case import every_case
from tests.service.waiting import ROOT, children, is_alive, until

PART = Path(__file__).parents[3] / "examples" / "parts" / "paper003_case1.stpnc"
DESIGN = f"""program = "{PART}"
machine = "paper003"
feed_mm_s = [60, 90]
spindle_rad_s = [75.4, 226.2]
depth_mm = [2.5, 3.5]
seed = 5
deviation = true
"""


class Inline(Executor):
    """Runs at once, and is interrupted after a number of tasks."""

    def __init__(self, most: int = 1000) -> None:
        self.left = most

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        if not self.left:
            raise KeyboardInterrupt
        self.left -= 1
        future: Future[Any] = Future()
        future.set_result(fn(*args, **kwargs))
        return future


@pytest.fixture
def design(tmp_path: Path) -> Path:
    path = tmp_path / "design.toml"
    path.write_text(DESIGN, encoding="utf-8")
    return path


def made(
    design: Path, folder: Path, rows: int | None, *, pool: Executor | None = None
) -> DatasetResult:
    inline = pool or Inline()
    return make_dataset(
        design, folder, rows=rows, tell=silent, pools=lambda: inline, partition=2
    )


def rows_of(folder: Path, rows: int) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = pa.concat_tables(
        DatasetFolder(folder, 2).tables(rows)
    ).to_pylist()
    return found


def test_a_row_is_a_run_of_the_virtual_machine(design: Path, tmp_path: Path) -> None:
    result = made(design, tmp_path / "data", 2)
    assert (result.rows, result.made) == (2, 2)
    row = rows_of(tmp_path / "data", 2)[1]
    program = Program.load(PART)
    cycle = part_cycle(
        program,
        load_machine("paper003"),
        material_for("", program),
        settings=CutSettings(
            feed=row["feed_mm_s"],
            spindle_speed=-rev_s_from_rad_s(row["spindle_rad_s"]),
            depth=row["depth_mm"],
        ),
    )
    assert row["time_s"] == pytest.approx(cycle.time, rel=1e-9)
    assert row["energy_exact_j"] == pytest.approx(cycle.energy, rel=1e-9)
    assert row["peak_power_w"] == pytest.approx(cycle.peak_power, rel=1e-9)
    assert row["total_power_w"] == pytest.approx(row["energy_j"] / row["time_s"])
    deviation = abs(row["energy_j"] / row["energy_exact_j"] - 1.0)
    assert 0.0 < deviation < 0.1
    assert (row["row"], row["machine"], row["material"]) == (2, "paper003", "aisi1018")


def test_an_interrupted_run_goes_on_to_the_same_rows(design: Path, tmp_path: Path) -> None:
    folder = tmp_path / "broken"
    with pytest.raises(KeyboardInterrupt):
        made(design, folder, 11, pool=Inline(5))
    kept = sum(each.num_rows for each in DatasetFolder(folder, 2).tables(11))
    assert kept == 4, "two partitions were whole, others on their way"
    assert made(design, folder, 11).made == 7
    made(design, tmp_path / "whole", 11)
    rows = rows_of(folder, 11)
    assert rows == rows_of(tmp_path / "whole", 11)
    assert [row["row"] for row in rows] == list(range(1, 12))
    assert made(design, folder, 11).made == 0


def test_a_data_set_is_extended(design: Path, tmp_path: Path) -> None:
    folder = tmp_path / "data"
    made(design, folder, 3)
    before = rows_of(folder, 3)
    assert made(design, folder, 5).made == 2
    after = rows_of(folder, 5)
    assert after[:3] == before
    assert [row["row"] for row in after] == [1, 2, 3, 4, 5]


def test_processes_make_the_same_rows(design: Path, tmp_path: Path) -> None:
    made(design, tmp_path / "one", 2)
    files = DatasetFiles(has_csv=True)
    make_dataset(design, tmp_path / "many", rows=2, tell=silent, files=files, partition=2)
    assert rows_of(tmp_path / "many", 2) == rows_of(tmp_path / "one", 2)
    table = csv.read_csv(tmp_path / "many" / "data.csv")
    assert table["energy_j"].to_pylist() == pytest.approx([
        row["energy_j"] for row in rows_of(tmp_path / "one", 2)
    ])


def test_without_deviation_the_energy_is_exact(design: Path, tmp_path: Path) -> None:
    design.write_text(DESIGN.replace("true", "false"), encoding="utf-8")
    made(design, tmp_path / "data", 1)
    (row,) = rows_of(tmp_path / "data", 1)
    assert row["energy_j"] == row["energy_exact_j"]


def test_columns_have_units_and_the_manifest_has_versions(design: Path, tmp_path: Path) -> None:
    folder = tmp_path / "data"
    made(design, folder, 1)
    schema = DatasetFolder(folder, 2).partition(0).schema
    assert schema.field("feed_mm_s").metadata == {b"unit": b"mm/s"}
    manifest = json.loads((folder / "manifest.json").read_text(encoding="utf-8"))
    metadata = parquet.read_schema(folder / "part-000000.parquet").metadata
    assert json.loads(metadata[b"stepnc_manifest"]) == manifest
    assert manifest["seed"] == 5
    assert set(manifest["versions"]) == {"stepnc-optimiser", "numpy"}


@every_case(
    ("old", "new", "rows", "message"),
    [
        ("seed", "seed", None, "has no end"),
        ("seed", "seed", 0, "-n 0"),
        ("seed", "seed", 10_000_001, "-n 10000001: it must be 1 to 10000000"),
        ("[60, 90]", "[90, 60]", 3, r"feed_mm_s: \[90, 60\]: expected a lower and a greater"),
        ("[60, 90]", "[60]", 3, r"feed_mm_s: \[60\]: expected a lower and a greater"),
        (
            "seed",
            'design = "full-factorial"\nlevels = 1000\nseed',
            None,
            "1000000000 combinations",
        ),
        (
            "seed",
            "tool_diameter_mm = [20, 60]\nseed",
            3,
            "tool diameter 20 mm: .* of 20 mm does not fit in",
        ),
        (".stpnc", ".missing", 3, "program: .*missing"),
        ('machine = "paper003"', 'machine = "paper002"', 3, "deviation: machine"),
        (
            'machine = "paper003"\nfeed_mm_s = [60, 90]',
            'machine = "vmc15"\nfeed_mm_s = [60, 4000]',
            3,
            "feed 4000 mm/s, spindle .*: feed .* exceeds",
        ),
        ('machine = "', 'material = "unobtainium"\nmachine = "', 3, "material: unknown"),
    ],
)
def test_bad_input_is_refused_before_anything_is_written(
    design: Path, tmp_path: Path, old: str, new: str, rows: int | None, message: str
) -> None:
    design.write_text(DESIGN.replace(old, new), encoding="utf-8")
    with pytest.raises(StepNcError, match=message):
        made(design, tmp_path / "data", rows)
    assert not (tmp_path / "data").exists()


def test_a_full_factorial_is_made_whole(design: Path, tmp_path: Path) -> None:
    text = DESIGN + 'design = "full-factorial"\nlevels = 2\n'
    design.write_text(text, encoding="utf-8")
    for rows in (7, 9):
        with pytest.raises(StepNcError, match=f"-n {rows}: the full factorial has 8 comb"):
            made(design, tmp_path / "data", rows)
    assert made(design, tmp_path / "data", None).rows == 8


def test_another_design_does_not_mix_with_rows_that_are_there(
    design: Path, tmp_path: Path
) -> None:
    made(design, tmp_path / "data", 1)
    design.write_text(DESIGN.replace("seed = 5", "seed = 6"), encoding="utf-8")
    with pytest.raises(StepNcError, match="seed: the rows there were made with 5, not 6"):
        made(design, tmp_path / "data", 2)
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "mine.txt").write_text("mine", encoding="utf-8")
    with pytest.raises(StepNcError, match=r"not empty, and without manifest\.json"):
        made(design, tmp_path / "other", 1)


def test_a_damaged_partition_is_told(design: Path, tmp_path: Path) -> None:
    made(design, tmp_path / "data", 2)
    (tmp_path / "data" / "part-000000.parquet").write_bytes(b"damaged")
    with pytest.raises(StepNcError, match=r"part-000000.parquet: is no Parquet file"):
        made(design, tmp_path / "data", 2)


def test_more_rows_than_the_disk_holds_are_refused(
    design: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("extras.learning.dataset_run.PARQUET_BYTES", 10**15)
    with pytest.raises(StepNcError, match=r"-n 100: .* needs about 1e\+08 GB, and .* are free"):
        made(design, tmp_path / "data", 100)
    assert not (tmp_path / "data").exists()


def test_a_worn_tool_needs_more_power_and_a_smaller_one_more_passes(
    design: Path, tmp_path: Path
) -> None:
    wide = DESIGN.replace("true", "false").replace("feed_mm_s = [60, 90]", "")
    sizes = "tool_diameter_mm = [6, 8]\nflank_wear_mm = [0, 0.3]\n"
    pocket = wide.replace("paper003_case1", "paper003_pocket").replace(
        "spindle_rad_s = [75.4, 226.2]\ndepth_mm = [2.5, 3.5]", sizes
    )
    text = pocket + 'design = "full-factorial"\nlevels = 2\n'
    design.write_text(text, encoding="utf-8")
    made(design, tmp_path / "data", None)
    small, small_worn, large, large_worn = rows_of(tmp_path / "data", 4)
    assert (small["tool_diameter_mm"], large_worn["flank_wear_mm"]) == (6.0, 0.3)
    assert small["time_s"] > 1.1 * large["time_s"]
    for sharp, worn in ((small, small_worn), (large, large_worn)):
        assert worn["time_s"] == sharp["time_s"]
        assert worn["cutting_power_w"] > 1.05 * sharp["cutting_power_w"]
        more = worn["total_power_w"] - sharp["total_power_w"]
        cut = worn["cutting_power_w"] - sharp["cutting_power_w"]
        assert cut < more < 1.5 * cut, "the axes feel the wear land too"


def test_the_program_of_a_row_runs_as_the_row_did(design: Path, tmp_path: Path) -> None:
    files, folder = DatasetFiles(has_programs=True), tmp_path / "data"
    make_dataset(design, folder, rows=2, tell=silent, files=files, pools=Inline, partition=2)
    names = sorted(each.name for each in (folder / "programs").iterdir())
    assert names == ["row-000001.stpnc", "row-000002.stpnc"]
    program = Program.load(folder / "programs" / "row-000002.stpnc")
    cycle = part_cycle(program, load_machine("paper003"), material_for("", program))
    row = rows_of(folder, 2)[1]
    assert (cycle.time, cycle.energy) == (row["time_s"], row["energy_exact_j"])
    with pytest.raises(StepNcError, match="-n 100001 with --programs: it must be at most"):
        make_dataset(design, folder, rows=100_001, tell=silent, files=files, pools=Inline)


class Killed(ProcessPoolExecutor):
    """Processes, of which one is ended by the system after some tasks."""

    def __init__(self, after: int) -> None:
        super().__init__(1, mp_context=get_context("forkserver"))
        self.left = after

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        self.left -= 1
        return super().submit(*((fn, *args) if self.left else (kill, os.getpid(), SIGKILL)))


def kill(_: int, signal: int) -> None:
    os.kill(os.getpid(), signal)


def test_rows_of_a_killed_process_are_made_again(design: Path, tmp_path: Path) -> None:
    pools, told = [Killed(4), Inline()], list[str]()
    result = make_dataset(
        design,
        tmp_path / "data",
        rows=11,
        tell=told.append,
        pools=lambda: pools.pop(0),
        partition=2,
    )
    assert (result.made, pools) == (11, [])
    assert [each["row"] for each in rows_of(tmp_path / "data", 11)] == list(range(1, 12))
    made(design, tmp_path / "whole", 11)
    assert rows_of(tmp_path / "data", 11) == rows_of(tmp_path / "whole", 11)
    assert any("a process was ended from outside" in each for each in told)


def test_processes_that_are_killed_again_and_again_are_told(
    design: Path, tmp_path: Path
) -> None:
    text = "rows 1 to 2: the processes that make them were ended 3 times"
    with pytest.raises(StepNcError, match=text):
        make_dataset(
            design, tmp_path / "data", rows=3, tell=silent, pools=lambda: Killed(1), partition=2
        )


SCRIPT = """
import sys
from pathlib import Path
from extras.learning.dataset_run import make_dataset
make_dataset(Path(sys.argv[1]), Path(sys.argv[2]), rows=30, tell=print, partition=3)
"""


def test_a_run_that_is_killed_goes_on_with_no_row_twice(design: Path, tmp_path: Path) -> None:
    folder = tmp_path / "data"
    command = [sys.executable, "-c", SCRIPT, str(design), str(folder)]
    run = subprocess.Popen(command, cwd=ROOT)
    try:
        until((folder / "part-000001.parquet").exists)
        below = children(run.pid)
    finally:
        run.kill()
        run.wait()
    until(lambda: not any(map(is_alive, below)))
    kept = sum(each.num_rows for each in DatasetFolder(folder, 3).tables(30))
    assert 6 <= kept < 30
    inline = Inline()
    result = make_dataset(
        design, folder, rows=30, tell=silent, pools=lambda: inline, partition=3
    )
    assert result.made == 30 - kept
    rows = pa.concat_tables(DatasetFolder(folder, 3).tables(30)).to_pylist()
    assert [each["row"] for each in rows] == list(range(1, 31))
    source = dataset_source(read_design(design), design)
    assert rows == [asdict(each) for each in source.rows(0, 30)]
    assert sorted(each.suffix for each in folder.iterdir()) == [".json", *[".parquet"] * 10]
