"""Plans for the parts of the examples."""

from dataclasses import replace
from functools import cache
from pathlib import Path

from optimiser.advice import Advice, EvaluatedSetting, Plan
from optimiser.cuts.source import from_features
from optimiser.modes import Free
from optimiser.optimise import optimise_program
from optimiser.planning.formulate import OptimisationTask
from simulator.library import load_machine, match_material
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program

PARTS = Path(__file__).parents[2] / "examples" / "parts"
USUAL = {
    "bracket": ("vmc15", "C45"),
    "paper002": ("paper002", "paper002"),
    "shaft": ("lathe22", "42CrMo4"),
}
DEEP_INSERT = ("$,55.,(#412),3.,$)", "$,55.,(#412),6.,$)")
"""Finishing insert of the shaft for the 4.1 mm that it meets at a shoulder."""

ALL_FREE = frozenset(Free)


def edited(name: str, *changes: tuple[str, str]) -> Program:
    """A sample part with some texts replaced."""
    text = (PARTS / f"{name}.stpnc").read_text()
    for before, after in changes:
        assert before in text
        text = text.replace(before, after)
    return Program(Part21File.from_bytes(text.encode(), name=name), name=name)


@cache
def measured(
    name: str, task: OptimisationTask, *changes: tuple[str, str], machine: str = ""
) -> Plan:
    """Advice along the real paths."""
    usual, material = USUAL[name]
    return optimise_program(
        edited(name, *changes),
        machine=load_machine(machine or usual),
        material=match_material([material]),
        task=task,
    )


def plan_of(
    name: str, task: OptimisationTask, *changes: tuple[str, str], machine: str = ""
) -> Plan:
    """Advice by the features."""
    return measured(name, replace(task, source=from_features), *changes, machine=machine)


def advice_of(plan: Plan, name: str) -> Advice:
    (found,) = (advice for advice in plan.advices if advice.workingstep.id == name)
    return found


def after(advice: Advice) -> EvaluatedSetting:
    assert advice.after is not None
    return advice.after


def before(advice: Advice) -> EvaluatedSetting:
    assert advice.before is not None
    return advice.before
