"""Variables that a Sinumerik program defines."""

import numpy as np

from stepnc_model.nc.program import read_program
from stepnc_model.post.dialect import Dialect

CODE = (
    "DEF REAL DEPTH=-2, SAFE_1=5\nDEF INT N1=3\nDEF STRING[20] NAME\n"
    "G17 G71 G90 G94 G54\nT1 D1\nM6\nS5000 M3\nG0 X-10 Y5 Z=SAFE_1\nG1 Z=DEPTH F500\nX60\n"
)


def test_moves_by_defined_variables_are_known() -> None:
    moves = read_program(CODE.encode(), dialect=Dialect.SINUMERIK).moves
    assert moves.end[:, 2].tolist() == [5.0, -2.0, -2.0]
    assert np.count_nonzero(moves.is_advisable) == 2


def test_a_variable_that_is_set_anew_has_its_new_value() -> None:
    code = CODE + "DEPTH=DEPTH-N1\nG1 Z=DEPTH\nDEPTH=UNKNOWN\nG1 Z=DEPTH\n"
    ends = read_program(code.encode(), dialect=Dialect.SINUMERIK).moves.end[:, 2]
    assert ends[-2] == -5.0
    assert np.isnan(ends[-1])


def test_a_condition_leaves_what_it_sets_open() -> None:
    code = CODE + "IF $A_IN[1]==1\nDEPTH=-9\nENDIF\nG1 Z=DEPTH\n"
    moves = read_program(code.encode(), dialect=Dialect.SINUMERIK).moves
    assert np.isnan(moves.end[-1, 2]) or not moves.is_advisable[-1]
