"""Workingsteps that a mill or a lathe cannot run."""

from pathlib import Path

import pytest

from optimiser.cuts.source import why_elsewhere
from simulator.library import load_machine
from stepnc_model.programs.program import Program

PARTS = Path(__file__).parents[2] / "examples" / "parts"


@pytest.mark.parametrize(
    ("part", "machine", "reason"),
    [
        ("bracket", "vmc15", ""),
        ("shaft", "lathe22", ""),
        ("bracket", "lathe22", "needs a mill, and 'lathe22' is a lathe"),
        ("shaft", "vmc15", "needs a lathe, and 'vmc15' is a mill"),
    ],
)
def test_milling_needs_a_mill_and_turning_a_lathe(part: str, machine: str, reason: str) -> None:
    program = Program.load(PARTS / f"{part}.stpnc")
    found = why_elsewhere(program.workingsteps[0], load_machine(machine))
    assert found.endswith(reason)
    assert bool(found) is bool(reason)
