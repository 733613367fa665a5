"""Programs of a folder: advised as one by one, once each, whatever is killed."""

import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from benchmarks.local_cluster import running_cluster
from optimiser.modes import Mode
from service.execution.pools import pools_of
from service.requests.advice import AdviceRequest
from service.verbs.optimise.folder import FolderFiles, optimise_programs
from service.verbs.optimise.ledger import LEDGER, ProgramStatus, known_rows
from service.verbs.optimise.program import advise_program as optimise
from service.verbs.optimise.request import AdviceFiles
from stepnc_model.errors import StepNcError, WriteError

PAPER = Path(__file__).parents[4] / "examples" / "parts" / "paper002.stpnc"
REQUEST = AdviceRequest()


def folder_of(tmp_path: Path, count: int = 3) -> FolderFiles:
    """A folder of programs that all differ a little."""
    folder = tmp_path / "programs"
    folder.mkdir()
    text = PAPER.read_text(encoding="utf-8")
    for number in range(count):
        place = folder / f"part-{number}.stpnc"
        place.write_text(text.replace("DATA;", f"DATA; /* {number} */", 1), encoding="utf-8")
    (folder / "notes.txt").write_text("no program", encoding="utf-8")
    return FolderFiles(folder=folder, output=tmp_path / "advised")


def test_programs_are_those_of_one_by_one_and_bad_ones_have_a_row(tmp_path: Path) -> None:
    files = folder_of(tmp_path)
    (files.folder / "bad.stp").write_text("ISO-10303-21; nothing", encoding="utf-8")
    found = optimise_programs(REQUEST, files)
    assert [row.status for row in found.rows] == [
        ProgramStatus.BAD,
        *3 * [ProgramStatus.ADVISED],
    ]
    assert found.rows[0].message.startswith("line 1, column 22: ")
    assert "bad.stp" not in {each.name for each in files.output.iterdir()}
    for row in found.rows[1:]:
        alone = tmp_path / "alone.stpnc"
        optimise(REQUEST, AdviceFiles(file=files.folder / row.program, output=alone))
        assert (files.output / row.program).read_bytes() == alone.read_bytes()
        assert row.time_after_s < row.time_before_s


def test_only_what_changed_is_advised_again(tmp_path: Path) -> None:
    files = folder_of(tmp_path)
    assert optimise_programs(REQUEST, files).made == 3
    assert optimise_programs(REQUEST, files).made == 0
    (files.output / "part-0.stpnc").unlink()
    changed = files.folder / "part-1.stpnc"
    changed.write_text(changed.read_text(encoding="utf-8") + "\n", encoding="utf-8")
    again = optimise_programs(REQUEST, files)
    assert again.made == 2
    assert len(again.rows) == 3
    assert optimise_programs(AdviceRequest(mode=Mode.EC), files).made == 3


def test_programs_that_are_gone_leave_the_ledger(tmp_path: Path) -> None:
    files = folder_of(tmp_path)
    optimise_programs(REQUEST, files)
    (files.folder / "part-2.stpnc").unlink()
    assert len(optimise_programs(REQUEST, files).rows) == 2
    assert set(known_rows(files.output)) == {"part-0.stpnc", "part-1.stpnc"}


def test_a_killed_run_goes_on_without_doing_a_program_twice(tmp_path: Path) -> None:
    files = folder_of(tmp_path, count=30)
    code = "from service.cli.main import optimise_main; optimise_main()"
    command = [sys.executable, "-c", code, str(files.folder), "-o", str(files.output)]
    process = subprocess.Popen(
        command, env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)},
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True,
    )  # fmt: skip
    try:
        while len(rows := known_rows(files.output)) < 5:
            assert process.poll() is None
    finally:
        os.kill(process.pid, signal.SIGKILL)
        process.wait()
    rows = known_rows(files.output)
    assert all((files.output / name).is_file() for name in rows)
    found = optimise_programs(REQUEST, files)
    assert found.made == 30 - len(rows)
    assert len(found.rows) == 30
    lines = (files.output / LEDGER).read_text(encoding="utf-8").splitlines()
    assert len(lines) == 31


def test_a_cluster_gives_the_same(tmp_path: Path) -> None:
    files = folder_of(tmp_path)
    optimise_programs(REQUEST, files)
    wanted = {name: row.time_after_s for name, row in known_rows(files.output).items()}
    data = (files.output / "part-1.stpnc").read_bytes()
    shutil.rmtree(files.output)
    with running_cluster(tmp_path, 1) as made:
        found = optimise_programs(REQUEST, files, pools=pools_of(made.address))
    assert {row.program: row.time_after_s for row in found.rows} == wanted
    assert (files.output / "part-1.stpnc").read_bytes() == data


def test_folders_that_are_not_usable_are_refused(tmp_path: Path) -> None:
    files = folder_of(tmp_path)
    with pytest.raises(WriteError, match="is the folder of the programs"):
        optimise_programs(REQUEST, FolderFiles(folder=files.folder, output=files.folder))
    empty = tmp_path / "empty"
    empty.mkdir()
    with pytest.raises(StepNcError, match="has no program"):
        optimise_programs(REQUEST, FolderFiles(folder=empty, output=files.output))
    output = files.folder / "notes.txt"
    with pytest.raises(WriteError, match="is a file"):
        optimise_programs(REQUEST, FolderFiles(folder=files.folder, output=output))
    assert not files.output.exists()


def test_a_dry_run_writes_the_ledger_only(tmp_path: Path) -> None:
    files = folder_of(tmp_path)
    dry = FolderFiles(folder=files.folder, output=files.output, dry_run=True)
    assert optimise_programs(REQUEST, dry).made == 3
    assert [each.name for each in files.output.iterdir()] == [LEDGER]
    assert optimise_programs(REQUEST, files).made == 3
