"""Grooving inserts: two corners and a flat."""

from collections.abc import Callable

import pytest

from stepnc_model.errors import SchemaError
from stepnc_model.toolpath.task import ToolPathTask
from stepnc_model.toolpath.turning.groove import GroovingInsert, insert_of
from stepnc_model.toolpath.turning.profile import highest, level_line

WALL = highest([
    level_line(15.0, -50.0, -29.0),
    level_line(12.0, -29.0, -25.0),
    level_line(15.0, -25.0, 0.0),
])


def test_the_insert_of_the_shaft_is_that_of_its_tool(job: Callable[..., ToolPathTask]) -> None:
    assert insert_of(job("THREAD RELIEF")) == GroovingInsert(width=3.0, corner=0.2, reach=12.0)


def test_an_insert_fits_where_both_corners_do() -> None:
    """3 mm in a groove of 4 mm: its left corner has 1 mm of room."""
    centres = GroovingInsert(width=3.0, corner=0.2, reach=12.0).rolled(WALL)
    assert centres.below(12.3) == [pytest.approx((-28.8, -27.8))]
    assert centres.at(-28.3) == pytest.approx(12.2)


def test_an_insert_does_not_sink_into_a_narrow_groove() -> None:
    assert GroovingInsert(width=5.0, corner=0.2, reach=12.0).rolled(WALL).at(-29.0) > 15.0


@pytest.mark.parametrize(
    ("edit", "message"),
    [
        (
            (".RIGHT.,3.,12.,0.2", ".RIGHT.,3.,12.,2."),
            "corner radius 2 mm is too large for the width 3 mm",
        ),
        ((".RIGHT.,3.,12.,0.2", ".RIGHT.,0.,12.,0.2"), "an insert width of 0"),
        (("5.,$,#420,#303", "5.,$,#400,#303"), "is not a grooving tool"),
    ],
)
def test_what_is_no_grooving_insert_is_refused(
    job: Callable[..., ToolPathTask], edit: tuple[str, str], message: str
) -> None:
    with pytest.raises(SchemaError, match=message):
        insert_of(job("THREAD RELIEF", edit))
