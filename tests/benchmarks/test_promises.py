"""The table of promised speeds."""

import pytest

from benchmarks.promises import ROWS, Measurement, Row, is_kept, main, table_line


def row(*, is_least: bool = False) -> Row:
    return Row(
        name="x", work="some work", measure=lambda: 1.0, unit="s", goal=2.0, is_least=is_least
    )


def test_rows_have_names_of_their_own() -> None:
    names = [row.name for row in ROWS]
    assert len(set(names)) == len(names)


@pytest.mark.parametrize(
    ("value", "at_most", "at_least"), [(1.9, True, False), (2.1, False, True)]
)
def test_a_goal_is_a_greatest_or_a_least_figure(
    value: float, at_most: bool, at_least: bool
) -> None:
    assert is_kept(row(), value) is at_most
    assert is_kept(row(is_least=True), value) is at_least


def test_a_line_shows_median_spread_goal_and_greatest_memory() -> None:
    runs = [Measurement(value=value, memory=10.0 * value) for value in (1.0, 9.0, 3.0)]
    words = table_line(row(), runs).split()
    assert words == ["some", "work", "3", "1…9", "≤", "2", "s", "NO", "90"]


def test_a_row_is_measured_in_a_process_of_its_own(
    capsys: pytest.CaptureFixture[str],
) -> None:
    main(["--only", "workingstep"])
    line = capsys.readouterr().out.splitlines()[-1]
    assert "closed form of a workingstep" in line
    assert 10 < int(line.split()[-1]) < 500


def test_an_unknown_row_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["--only", "nonsense"])
    assert "no row nonsense: workingstep" in capsys.readouterr().err
