"""Programs outside the file that are said to keep the modal state."""

import numpy as np
import pytest

from stepnc_model.nc.program import read_program
from stepnc_model.post.dialect import Dialect

CODE = (
    "%\nO1\nG21 G90 G17 G54\nT1 M6\nS5000 M3\n{call}\nG0 X0 Y0\nZ5.\nG1 Z-2. F500.\nX60.\nM30\n"
)


@pytest.mark.parametrize("call", ["M98 P9000", "G65 P9000 A1."])
def test_what_follows_is_known_by_absolute_words(call: str) -> None:
    data = CODE.format(call=call).encode()
    lost = read_program(data, dialect=Dialect.FANUC)
    assert not lost.moves.is_advisable.any()
    assert any("--keeps-state P9000" in each.message for each in lost.findings)
    kept = read_program(data, dialect=Dialect.FANUC, keeps_state=frozenset({9000}))
    assert np.count_nonzero(kept.moves.is_advisable) == 2
    # Where the call left the tool is open, until each axis has a word again.
    assert not kept.moves.is_known[0]
    other = read_program(data, dialect=Dialect.FANUC, keeps_state=frozenset({9001}))
    assert not other.moves.is_advisable.any()
