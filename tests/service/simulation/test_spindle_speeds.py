"""Speeds of spindles that turn at one which the program does not state."""

import numpy as np
import pytest

from service.simulation.spindle_speeds import speeds_in, with_spindles
from stepnc_model.errors import StepNcError
from stepnc_model.nc.program import read_program

CODE = b"G21 G90 G17\nT1 M6\nM3\nG0 X0 Y0 Z5\nG1 Z-2 F500\nS600\nX60\nM5\nX70\n"


def test_a_speed_that_is_not_stated_is_not_known() -> None:
    speeds = read_program(CODE).moves.spindle
    assert np.isnan(speeds[:2]).all()
    assert speeds[2:].tolist() == [10.0, 0.0]


def test_a_given_speed_counts_where_the_program_states_none() -> None:
    program = with_spindles(read_program(CODE), speeds_in(("T1=18000",)))
    assert program.moves.spindle.tolist() == [300.0, 300.0, 10.0, 0.0]
    other = with_spindles(read_program(CODE), speeds_in(("T2=18000",)))
    assert np.isnan(other.moves.spindle[0])
    assert with_spindles(read_program(CODE), speeds_in(("6000",))).moves.spindle[0] == 100.0


@pytest.mark.parametrize(
    "words", [("T1=",), ("T1=-5",), ("T1=1e9",), ("X=5",), ("T1=nan",), ("T1=5", "T1=6")]
)
def test_other_words_are_refused(words: tuple[str, ...]) -> None:
    with pytest.raises(StepNcError, match="spindle speed"):
        speeds_in(words)
