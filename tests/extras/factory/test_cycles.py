"""Cycles of programs on machines: as `stepnc simulate`, run once, refused with reasons."""

from dataclasses import replace
from pathlib import Path

import pytest

from extras.factory.cycles import PartCycles, part_cycle
from service.programs.machine_choice import material_for
from service.simulation.run import simulate
from simulator.library import load_machine
from simulator.spec import Machine
from stepnc_model.editing.cut_settings import CutSettings
from stepnc_model.errors import StepNcError
from stepnc_model.programs.program import Program
from tests.asking import asked_simulation
from tests.every_case import every_case

PARTS = Path(__file__).parents[3] / "examples" / "parts"


def loaded(name: str) -> Program:
    return Program.load(PARTS / f"{name}.stpnc")


@pytest.mark.parametrize(
    ("name", "machine"),
    [("paper003_case2", "paper003"), ("paper000", "paper000"), ("shaft", "lathe22")],
)
def test_a_cycle_is_a_run_of_simulate(name: str, machine: str) -> None:
    program = loaded(name)
    cycle = part_cycle(program, load_machine(machine), material_for("", program))
    file = PARTS / f"{name}.stpnc"
    whole = simulate(*asked_simulation(file, machine=machine)).whole
    assert cycle.time == pytest.approx(whole.duration, rel=1e-12)
    assert cycle.energy == pytest.approx(whole.energy.total, rel=1e-12)


def test_settings_are_those_of_the_part() -> None:
    program = loaded("paper003_case1")
    machine, material = load_machine("paper003"), material_for("", program)
    plain = part_cycle(program, machine, material)
    fast = part_cycle(program, machine, material, settings=CutSettings(feed=60.0, depth=3.0))
    assert len(fast.feed_energies) < len(plain.feed_energies)
    assert fast.time < 0.2 * plain.time


def test_a_run_is_remembered_by_what_determines_it() -> None:
    program = loaded("paper003_case2")
    machine, material = load_machine("paper003"), material_for("", program)
    told: list[str] = []
    cycles = PartCycles(tell=told.append)
    first = cycles.cycle(program, machine, material)
    assert cycles.cycle(loaded("paper003_case2"), replace(machine), material) is first
    other = cycles.cycle(program, replace(machine, base_power=400.0), material)
    assert other is not first
    assert other.energy == pytest.approx(first.energy + 30.0 * first.time)
    softer = material_for("c45", program)
    assert cycles.cycle(program, machine, softer).energy != first.energy
    quick = cycles.cycle(program, machine, material, CutSettings(feed=10.0))
    assert quick.time < first.time
    assert cycles.cycle(program, machine, material, CutSettings(feed=10.0)) is quick


def test_what_the_run_finds_is_told() -> None:
    program, told = loaded("shaft"), list[str]()
    part_cycle(program, load_machine("lathe22"), material_for("", program), tell=told.append)
    assert any(
        "shaft.stpnc on machine 'lathe22'" in text and "threading is not modelled" in text
        for text in told
    )


def short(machine: Machine) -> Machine:
    axes = tuple(replace(axis, travel=(0.0, 50.0)) for axis in machine.axes)
    return replace(machine, axes=axes)


MILL = load_machine("vmc15")


@every_case(
    ("name", "machine", "settings", "message"),
    [
        (
            "paper003_case1",
            load_machine("lathe22"),
            None,
            "paper003_case1.stpnc on machine 'lathe22': workingstep 'MILL SLOT': milling or "
            "drilling, but the machine is a lathe",
        ),
        ("shaft", MILL, None, "machine is a mill"),
        (
            "paper003_case1",
            MILL,
            CutSettings(spindle_speed=-300.0),
            "exceeds 12000 rpm",
        ),
        (
            "paper003_case1",
            MILL,
            CutSettings(spindle_speed=-0.5),
            "below 50 rpm",
        ),
        (
            "paper003_case1",
            MILL,
            CutSettings(feed=400.0),
            "exceeds 20000 mm/min",
        ),
        (
            "paper003_case1",
            load_machine("paper002"),
            None,
            "no data for its axes",
        ),
        ("paper003_case1", short(MILL), None, "workingstep 'MILL SLOT': line "),
        ("paper003_case1", short(MILL), None, "outside the travel"),
    ],
)
def test_what_the_machine_cannot_do_is_told(
    name: str, machine: Machine, settings: CutSettings | None, message: str
) -> None:
    program = loaded(name)
    with pytest.raises(StepNcError) as caught:
        part_cycle(program, machine, material_for("", program), settings=settings)
    assert message in str(caught.value)
    assert f"{program.name} on machine '{machine.name}'" in str(caught.value)
