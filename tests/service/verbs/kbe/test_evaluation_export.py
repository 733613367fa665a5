"""The evaluation table for other programs."""

from pathlib import Path

import pytest

from service.knowledge.evaluation_columns import FILE_COLUMNS, lines
from service.knowledge.evaluation_table import EvaluationTable, table
from service.rendering.columns import file_columns, file_rows
from service.requests.knowledge import EvaluationRequest
from service.verbs.kbe.table.result import EvaluationResult
from stepnc_model.units import m_min_from_speed


@pytest.fixture(scope="module")
def found(shop_file: Path) -> EvaluationTable:
    return table(str(shop_file), EvaluationRequest())


def test_every_side_is_a_line_with_every_column(found: EvaluationTable) -> None:
    rows = list(file_rows(FILE_COLUMNS, lines(found.rows)))
    fields = file_columns(FILE_COLUMNS)
    assert len(rows) == len(list(lines(found.rows)))
    for row in rows:
        assert set(row) == {field.name for field in fields}
        for field in fields:
            assert row[field.name] is None or isinstance(row[field.name], field.kind)


def test_units_are_those_of_the_names(found: EvaluationTable) -> None:
    line, row = next(
        (line, next(file_rows(FILE_COLUMNS, [line]))) for line in lines(found.rows)
    )
    side = line.side
    assert side.cutting_speed is not None
    assert row["cutting_speed_m_min"] == m_min_from_speed(side.cutting_speed)
    assert row["length_mm"] == line.row.length
    force = side.deviations[next(each for each in side.deviations if each == "force")]
    assert force.mean is not None
    assert row["force_mean_percent"] == pytest.approx(100.0 * force.mean, rel=1e-12)


def test_json_has_rows_with_sides_and_remarks_in_parts(found: EvaluationTable) -> None:
    told = EvaluationResult(evaluation=found).record()
    assert told["outcomes"] == 1200
    assert (told["by"], told["only"], told["sort"]) == ("feature", "all", "name")
    assert len(told["rows"]) == len(found.rows)
    sides = [
        side for row in told["rows"] for side in (row["roughing"], row["finishing"]) if side
    ]
    assert sum(side["outcomes"] for side in sides) == 1200
    assert any(side["remarks"] for side in sides)
    assert {key for side in sides for each in side["remarks"] for key in each} == {
        "about",
        "action",
        "observed",
        "advice",
    }
