"""Sources of cuts."""

from dataclasses import replace
from pathlib import Path

from optimiser.cuts.path_cuts import MeasuredCuts
from optimiser.cuts.source import along_paths, from_features
from simulator.library import load_machine, load_material
from stepnc_model.programs.program import Program

PARTS = Path(__file__).parents[3] / "examples" / "parts"


def test_features_say_the_same_at_every_setting() -> None:
    program = Program.load(PARTS / "paper002.stpnc")
    cuts = from_features(program, load_machine("paper002"), load_material("paper002"))
    (step,) = program.workingsteps
    cut, _ = cuts.cut(step)
    assert cuts.at(step, cut, replace(cut.programmed, feed=0.3)) == cut


def test_paths_are_measured_with_the_exponent_of_the_material() -> None:
    program = Program.load(PARTS / "paper002.stpnc")
    material = load_material("paper002")
    cuts = along_paths(program, load_machine("paper002"), material)
    assert isinstance(cuts, MeasuredCuts)
    assert cuts.kienzle == material.kienzle
