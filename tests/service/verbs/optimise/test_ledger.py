"""Ledger of programs: rows come back as they were, damaged ones do not count."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.verbs.optimise.ledger import LEDGER, Ledger, ProgramRow, ProgramStatus, known_rows
from stepnc_model.errors import StepNcError, WriteError
from tests.full_disk import files_of_at_most

ROW = ProgramRow(
    program='a "b", c.stpnc', status=ProgramStatus.INFEASIBLE, workingsteps=3, advised=2,
    time_before_s=1.25, time_after_s=1e-3, message="infeasible: WS 1", digest="0a",
)  # fmt: skip


def test_rows_come_back(tmp_path: Path) -> None:
    with Ledger(tmp_path, []) as book:
        book.add(ROW)
    assert known_rows(tmp_path) == {ROW.program: ROW}
    with Ledger(tmp_path, [ROW]):
        assert known_rows(tmp_path) == {ROW.program: ROW}


@given(cut=st.integers(min_value=1, max_value=200))
def test_a_row_that_was_broken_off_does_not_count(
    tmp_path_factory: pytest.TempPathFactory, cut: int
) -> None:
    folder = tmp_path_factory.mktemp("ledger")
    other = ProgramRow(program="other.stpnc", status=ProgramStatus.ADVISED)
    with Ledger(folder, [ROW, other]):
        pass
    place = folder / LEDGER
    whole = place.read_bytes()
    place.write_bytes(whole[: max(len(whole) - cut, whole.find(b"\n") + 1)])
    found = known_rows(folder)
    assert "other.stpnc" not in found
    assert all(found[name] == ROW for name in found)


def test_messages_take_one_line(tmp_path: Path) -> None:
    bad = ProgramRow(program="a", status=ProgramStatus.BAD, message="line 1\nline 2")
    with Ledger(tmp_path, [bad]):
        pass
    assert known_rows(tmp_path)["a"].message == "line 1 line 2"


def test_other_files_of_that_name_are_not_overwritten(tmp_path: Path) -> None:
    (tmp_path / LEDGER).write_text("name,price\n", encoding="utf-8")
    with pytest.raises(StepNcError, match="is no ledger of `optimise`"):
        known_rows(tmp_path)


def test_a_full_disk_is_named(tmp_path: Path) -> None:
    with files_of_at_most(10), pytest.raises(WriteError, match=LEDGER):
        Ledger(tmp_path, [])
    assert not (tmp_path / LEDGER).exists()
