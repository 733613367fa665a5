"""Programs on a real LinuxCNC: where they end, and what is told of those that do not."""

import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from extras.linuxcnc.bench import LinuxCncFailed, run_programs
from simulator.spec import Machine
from tests.service.waiting import ROOT, until

pytestmark = pytest.mark.usefixtures("linuxcnc")

CORNER = """G21 G90 G94 G17
G64 P0.01
T3 M6
G43 H3
S1200 M3
G0 X5 Y0 Z0
G1 X15 F3000
Y10
M1
M2
"""


def written(folder: Path, **programs: str) -> list[Path]:
    paths = []
    for name, text in programs.items():
        paths.append(folder / f"{name}.ngc")
        paths[-1].write_text(text)
    return paths


def test_programs_run_to_their_end_one_after_another(tmp_path: Path, mill: Machine) -> None:
    broken = CORNER.replace("Y10", "Y10\nG1 X30 F0\nX40")
    paths = written(tmp_path, corner=CORNER, broken=broken, again=CORNER)
    corner, stopped, again = run_programs(mill, paths, starts=[(5.0, 0.0, 0.0)] * 3)
    for run in (corner, again):
        assert run.messages == ()
        assert run.last_line == 8
        assert run.end == pytest.approx([15.0, 10.0, 0.0], abs=1e-6)
        motion = run.motion
        # Two moves of 10 mm at 50 mm/s from rest to rest, with little lost at the corner.
        assert (motion.speed > 0.0).sum() * motion.period == pytest.approx(0.422, abs=0.02)
        assert motion.speed.max() == pytest.approx(50.0)
        assert motion.spindle.max() == pytest.approx(20.0)
    assert len(stopped.messages) == 1
    assert stopped.last_line < 10


def test_a_program_that_does_not_end_is_told(tmp_path: Path, mill: Machine) -> None:
    paths = written(tmp_path, waits=CORNER.replace("M1", "M0"))
    with pytest.raises(LinuxCncFailed, match="the end of the program: not within 1 s"):
        run_programs(mill, paths, patience=1.0)


KILLED = """
import sys
from pathlib import Path
from simulator.library import load_machine
from extras.linuxcnc.bench import run_programs
run_programs(load_machine("vmc15"), [Path(sys.argv[1])])
"""


def test_nothing_is_left_when_its_owner_is_killed(tmp_path: Path, mill: Machine) -> None:
    (waits,) = written(tmp_path, waits=CORNER.replace("M1", "M0"))
    owner = subprocess.Popen([sys.executable, "-c", KILLED, waits], cwd=ROOT)
    until(lambda: "milltask" in names_below(owner.pid))
    left = below(owner.pid)
    owner.kill()
    owner.wait()
    until(lambda: not any(Path(f"/proc/{pid}").exists() for pid in left))
    (run,) = run_programs(mill, written(tmp_path, corner=CORNER))
    assert run.last_line == 8


def test_two_run_at_once(tmp_path: Path, mill: Machine) -> None:
    paths = written(tmp_path, corner=CORNER, farther=CORNER.replace("Y10", "Y30"))
    with ThreadPoolExecutor() as pool:
        runs = list(pool.map(lambda path: run_programs(mill, [path])[0], paths))
    assert [run.end[1] for run in runs] == pytest.approx([10.0, 30.0])


def below(pid: int) -> list[int]:
    """Processes that a process started, and those that they started."""
    found = []
    for task in Path(f"/proc/{pid}/task").glob("*/children"):
        for child in task.read_text().split():
            found += [int(child), *below(int(child))]
    return found


def names_below(pid: int) -> set[str]:
    names = set()
    for each in below(pid):
        try:
            names.add(Path(f"/proc/{each}/comm").read_text().strip())
        except OSError:
            continue  # it has ended meanwhile
    return names
