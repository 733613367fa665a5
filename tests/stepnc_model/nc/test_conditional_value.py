"""Alarms and values that a condition may set, where the condition is not known."""

import numpy as np
import pytest

from stepnc_model.nc.program import read_program
from stepnc_model.post.dialect import Dialect

BEHIND = "T1 M6\nS5000 M3\nG0 X0 Y0 Z5.\nG1 Z-2. F500.\nX60.\nM30\n"


def advisable(statement: str) -> int:
    """Number of feed moves behind a statement whose feed may be advised."""
    code = f"%\nO1\nG21 G90 G17\n#1=5\n{statement}\n{BEHIND}"
    moves = read_program(code.encode(), dialect=Dialect.FANUC).moves
    return int(np.count_nonzero(moves.is_advisable))


def test_an_alarm_is_no_jump() -> None:
    assert advisable("IF [#5405 GE 6000] THEN #3000=15 (TOOL LIFE)") == 2


def test_a_variable_that_may_be_set_is_not_known() -> None:
    assert advisable("IF [#4120 EQ 3] THEN #1=7") == 2
    assert advisable("IF [#4120 EQ 3] THEN #1=7\nG52 X#1") == 2
    code = f"%\nO1\nG21 G90 G17\n#1=5\nIF [#4120 EQ 3] THEN #1=7\n{BEHIND}G1 X#1\n"
    moves = read_program(code.replace("M30\n", "").encode(), dialect=Dialect.FANUC).moves
    assert np.isnan(moves.end[-1, 0])


@pytest.mark.parametrize(
    "statement", ["IF [#4120 EQ 3] THEN #5221=7", "IF [#4120 EQ 3] GOTO 9"]
)
def test_offsets_and_jumps_leave_what_follows_open(statement: str) -> None:
    assert advisable(statement) == 0
