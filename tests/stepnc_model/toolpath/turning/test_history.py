"""The bar as earlier workingsteps left it."""

from collections.abc import Callable

import pytest

from stepnc_model.toolpath.task import ToolPathTask
from stepnc_model.toolpath.turning.outline import outline_of
from stepnc_model.toolpath.turning.region import TurningBlank, bar_of


def bar(job: Callable[..., ToolPathTask], name: str, *edits: tuple[str, str]) -> TurningBlank:
    at = job(name, *edits)
    return bar_of(at, tuple(outline_of(at, ref, 30.0) for ref in at.step.features))


def test_the_first_workingstep_finds_the_whole_bar(job: Callable[..., ToolPathTask]) -> None:
    first = bar(job, "ROUGH FACE")
    assert (first.radius, first.left.low, first.left.high) == (30.0, -150.0, 2.0)


def test_a_roughed_face_leaves_its_allowance(job: Callable[..., ToolPathTask]) -> None:
    assert bar(job, "FINISH FACE").left.high == pytest.approx(0.5)
    assert bar(job, "ROUGH CONTOUR").left.high == pytest.approx(0.0)


def test_a_roughed_contour_leaves_its_allowance(job: Callable[..., ToolPathTask]) -> None:
    left = bar(job, "FINISH CONTOUR").left
    assert left.at(-20.0) == pytest.approx(15.5)
    assert left.at(-100.0) == pytest.approx(27.5)
    assert left.at(-120.0) == 30.0


def test_the_thread_finds_its_relief(job: Callable[..., ToolPathTask]) -> None:
    assert bar(job, "THREAD M30 X 2").left.at(-27.0) == pytest.approx(12.5)


def test_the_part_is_what_no_feature_removes(job: Callable[..., ToolPathTask]) -> None:
    part = bar(job, "ROUGH FACE").part
    assert part.high == 0.0
    assert [part.at(z) for z in (-27.0, -50.0, -120.0)] == pytest.approx([12.5, 20.0, 30.0])


def test_without_a_bar_the_features_say_how_large_it_is(
    job: Callable[..., ToolPathTask],
) -> None:
    found = bar(job, "ROUGH CONTOUR", ("0.02,$,$,#33,(#36)", "0.02,$,$,$,(#36)"))
    assert found.radius == 27.0
    assert "54 mm diameter" in str(found.findings[0])
