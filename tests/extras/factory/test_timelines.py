"""Timelines of programs."""

from pathlib import Path

import pytest

from extras.factory.cycles import part_cycle
from extras.factory.shop_observations import part_timeline
from service.programs.machine_choice import material_for
from service.programs.reading import read_program
from simulator.library import load_machine
from stepnc_model.errors import StepNcError
from tests.extras.factory.shops import PARTS


def test_a_timeline_has_the_time_and_energy_of_the_cycle() -> None:
    machine = load_machine("vmc15")
    program = read_program(PARTS / "paper003_case1.stpnc", units="iso")
    material = material_for("", program)
    cycle = part_cycle(program, machine, material)
    timeline = part_timeline(program, machine, material, rate=5.0)
    assert timeline.samples.time[-1] == pytest.approx(cycle.time, abs=0.3)
    energy = timeline.samples.total_power.sum() / 5.0
    assert energy == pytest.approx(cycle.energy, rel=0.01)
    assert timeline.workingsteps == tuple(step.id for step in program.workingsteps)


def test_a_machine_that_cannot_run_the_program_is_named() -> None:
    program = read_program(Path(PARTS / "shaft.stpnc"), units="iso")
    with pytest.raises(StepNcError, match=r"shaft\.stpnc"):
        part_timeline(program, load_machine("vmc15"), material_for("", program), rate=1.0)
