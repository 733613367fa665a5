"""All that we write for LinuxCNC, run by it, and beside the model of its planner."""

import re
from pathlib import Path

import pytest

import stepnc
from benchmarks.linuxcnc import EXAMPLES, PARTS, Comparison, compared, experiments, posted
from simulator.library import load_machine
from simulator.motion.model_name import ControlModelName

pytestmark = pytest.mark.usefixtures("linuxcnc")

NEAR = 0.002
"""Distance from the path that servo periods and rounded coordinates leave, mm."""


def check(found: Comparison, program: Path) -> None:
    """It ended where it should, within its tolerance, and as the model has it."""
    assert found.is_complete, (found.run.messages, found.run.last_line, found.run.end)
    tolerances = [float(p) for p in re.findall(r"G64 P([\d.]+)", program.read_text())]
    assert found.control_deviation <= max(tolerances) + NEAR
    assert found.ratio(ControlModelName.LINUXCNC) == pytest.approx(1.0, abs=0.01)
    assert [step for step in found.steps if not step.is_met] == []
    assert abs(found.model_deviation - found.control_deviation) <= 0.01
    # Where two moves overlap, the model keeps the corner that the control rounds.
    assert found.apart <= max(0.0105, 0.3 * max(tolerances))


@pytest.mark.parametrize("part", PARTS)
def test_a_posted_part_ends_on_its_path_and_in_its_time(part: str, tmp_path: Path) -> None:
    program = posted(part, "posted", tmp_path)
    (found,) = compared(load_machine(PARTS[part]), [program])
    check(found, program)


@pytest.mark.parametrize("part", PARTS)
def test_an_optimised_part_does_too(part: str, tmp_path: Path) -> None:
    output = tmp_path / f"{part}.stpnc"
    stepnc.optimise(
        str(EXAMPLES / f"{part}.stpnc"),
        machine=PARTS[part],
        output=str(output),
        nc_control="linuxcnc",
        material="" if part in {"bracket", "shaft"} else "c45",
    )
    (program,) = tmp_path.glob("*.ngc")
    (found,) = compared(load_machine(PARTS[part]), [program])
    check(found, program)


@pytest.mark.parametrize("mode", ["P0.01 Q0", "G61", "G61.1"])
def test_other_path_modes_are_modelled_too(mode: str, tmp_path: Path) -> None:
    (found,) = compared(load_machine("vmc15"), [posted("paper003_pocket", mode, tmp_path)])
    assert found.is_complete
    assert found.ratio(ControlModelName.LINUXCNC) == pytest.approx(1.0, abs=0.002)
    assert found.apart <= 0.002


def test_corners_circles_and_a_spiral_are_as_the_model_has_them(tmp_path: Path) -> None:
    for program in experiments(tmp_path):
        # A busy host starves the control of short lines, and loses samples.
        assert any(
            is_as_planned(run)
            for _ in range(3)
            for run in compared(load_machine("vmc15"), [program], speedup=1.0)
        ), program.name


def is_as_planned(run: Comparison) -> bool:
    """True if a run has the path and the time of the model."""
    error = run.model_times[ControlModelName.LINUXCNC] - run.control_time
    # Where lines are short the control starts before its queue is full.
    is_in_time = abs(error) <= max(0.01 * run.control_time, 0.020)
    return run.is_complete and run.apart <= 0.01 and is_in_time
