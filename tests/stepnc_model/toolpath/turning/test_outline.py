"""Outlines of turning features, read off the shaft and its variations."""

from collections.abc import Callable
from math import pi, tan

import pytest

from stepnc_model.errors import SchemaError
from stepnc_model.toolpath.task import ToolPathTask
from stepnc_model.toolpath.turning.outline import FeatureOutline, outline_of

END = "ENDSEC;\nEND-"


def outlines(job: Callable[..., ToolPathTask], *edits: tuple[str, str]) -> list[FeatureOutline]:
    at = job("ROUGH CONTOUR", *edits)
    return [outline_of(at, ref, 30.0) for ref in at.step.features]


def collar(job: Callable[..., ToolPathTask], text: str, extra: str = "") -> FeatureOutline:
    """The second feature, written anew."""
    old = "#120=OUTER_DIAMETER('COLLAR',#30,(#202,#203),#121,#123,#124,$)"
    return outlines(job, (old, f"#120={text}"), (END, extra + END))[1]


def test_a_contour_runs_from_the_front_to_the_chuck(job: Callable[..., ToolPathTask]) -> None:
    contour = outlines(job)[0]
    assert contour.pieces[0].start == (0.0, 13.5)
    assert contour.pieces[-1].end == (-80.0, 27.0)
    assert contour.radii == (13.5, 27.0)


def test_a_diameter_reaches_from_its_placement_to_the_chuck(
    job: Callable[..., ToolPathTask],
) -> None:
    (piece,) = outlines(job)[1].pieces
    assert (piece.start, piece.end) == ((-80.0, 27.0), (-110.0, 27.0))


def test_a_taper_reduces_the_diameter(job: Callable[..., ToolPathTask]) -> None:
    head = "OUTER_DIAMETER('C',#30,(),#121,#123,#124,#600)"
    by_diameter = "#600=DIAMETER_TAPER(#601);\n#601=TOLERANCED_LENGTH_MEASURE(50.,#510);\n"
    assert collar(job, head, by_diameter).pieces[0].end == (-110.0, 25.0)
    by_angle = collar(job, head, "#600=ANGLE_TAPER(10.);\n").pieces[0].end
    assert by_angle == pytest.approx((-110.0, 27.0 - 30.0 * tan(pi / 18.0)))


def test_a_taper_beyond_the_axis_is_refused(job: Callable[..., ToolPathTask]) -> None:
    with pytest.raises(SchemaError, match="beyond the axis"):
        collar(
            job, "OUTER_DIAMETER('C',#30,(),#121,#123,#124,#600)", "#600=ANGLE_TAPER(45.);\n"
        )


def test_a_shoulder_has_a_radius_and_reaches_the_outside(
    job: Callable[..., ToolPathTask],
) -> None:
    shape = collar(
        job,
        "OUTER_DIAMETER_TO_SHOULDER('C',#30,(),#121,#123,#600)",
        "#600=VEE_PROFILE(#601,#135,90.,0.);\n#601=AXIS2_PLACEMENT_3D('',#602,#501,#502);\n"
        "#602=CARTESIAN_POINT('',(0.,0.,-30.));\n",
    )
    assert shape.pieces[0].end == pytest.approx((-109.8, 27.0))
    assert shape.pieces[1].radius == pytest.approx(0.2)
    assert shape.pieces[-1].end == pytest.approx((-110.0, 30.0))


def test_a_rounded_edge_is_an_arc_from_x_towards_z(job: Callable[..., ToolPathTask]) -> None:
    shape = collar(
        job,
        "REVOLVED_ROUND('C',#30,(),#121,#505,20.,#600)",
        "#600=PARTIAL_CIRCULAR_PROFILE($,#601,90.);\n"
        "#601=TOLERANCED_LENGTH_MEASURE(3.,#510);\n",
    )
    assert shape.pieces[0].start == pytest.approx((-77.0, 20.0))
    assert shape.pieces[-1].end == pytest.approx((-80.0, 23.0))
    assert shape.pieces[0].centre == pytest.approx((-80.0, 20.0))


@pytest.mark.parametrize(
    ("edit", "message"),
    [
        (
            ("'MATERIAL INSIDE',(-1.", "'MATERIAL INSIDE',(1."),
            "the material lies outside the surface: internal turning is not supported",
        ),
        (
            ("'COLLAR',#122,#501,#502", "'COLLAR',#122,#502,#501"),
            "the feature's axis is not parallel to the spindle axis",
        ),
        (("(0.,0.,-80.)", "(9.,0.,-80.)"), "9 mm off the spindle axis"),
        (("(15.,0.,-40.)", "(15.,2.,-40.)"), "does not lie in a plane"),
    ],
)
def test_what_does_not_turn_about_the_axis_is_refused(
    job: Callable[..., ToolPathTask], edit: tuple[str, str], message: str
) -> None:
    with pytest.raises(SchemaError, match=message):
        outlines(job, edit)
