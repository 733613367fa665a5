"""Ways between passes as a strategy writes them."""

from collections.abc import Callable

import pytest

from stepnc_model.errors import SchemaError
from stepnc_model.toolpath.task import ToolPathTask
from stepnc_model.toolpath.turning.profile import HalfPlane
from stepnc_model.toolpath.turning.setting import link_of

Jobs = Callable[..., ToolPathTask]


def test_the_ways_are_those_of_the_file(job: Jobs) -> None:
    link = link_of(job("ROUGH CONTOUR"), HalfPlane())
    assert (link.ahead, link.lift, link.lift_height) == ((-1.0, 0.0), (0.0, 1.0), 1.0)
    assert (link.back, link.stepover) == ((1.0, 0.0), (0.0, -1.0))
    assert link.findings == ()


def test_a_face_sees_them_across_the_axis(job: Jobs) -> None:
    link = link_of(job("ROUGH FACE"), HalfPlane(is_across=True))
    assert (link.ahead, link.lift) == ((-1.0, 0.0), (0.0, 1.0))
    assert (link.back, link.stepover) == ((1.0, 0.0), (0.0, -1.0))


def test_nothing_given_is_nothing_assumed(job: Jobs) -> None:
    edit = ("(2.),$,#504,#501,#502,#506,1.,$,$", "(2.),$,#504,$,$,$,$,$,$")
    link = link_of(job("ROUGH CONTOUR", edit), HalfPlane())
    assert (link.lift, link.back, link.stepover) == (None, None, None)


def test_one_of_back_and_step_over_brings_the_other(job: Jobs) -> None:
    edit = ("(2.),$,#504,#501,#502,#506,1.,$,$", "(2.),$,#504,$,$,#506,$,$,$")
    link = link_of(job("ROUGH CONTOUR", edit), HalfPlane())
    assert (link.back, link.stepover) == ((1.0, 0.0), (0.0, -1.0))


def test_an_oblique_feed_of_straight_passes_is_said(job: Jobs) -> None:
    edits = (
        ("(2.),$,#504,#501", "(2.),$,#911,#501"),
        ("#500=CARTESIAN", "#911=DIRECTION('',(-0.1,0.,-1.));\n#500=CARTESIAN"),
    )
    (finding,) = link_of(job("ROUGH CONTOUR", *edits), HalfPlane()).findings
    assert "oblique" in finding.message
    assert finding.attribute == "feed_direction"


def test_a_negative_lift_is_refused(job: Jobs) -> None:
    with pytest.raises(SchemaError, match="is not a valid l"):
        link_of(
            job("ROUGH CONTOUR", ("#506,1.,$,$);\n#353", "#506,-1.,$,$);\n#353")), HalfPlane()
        )
