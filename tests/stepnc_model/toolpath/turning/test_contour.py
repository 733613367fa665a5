"""Roughing and finishing of the shaft: numbers of its drawing."""

from collections.abc import Callable

import pytest

from stepnc_model.toolpath.path import Move, MoveType, ToolPath


def cuts(path: ToolPath) -> list[Move]:
    return [move for move in path.moves if move.type is MoveType.CONTACT]


def test_roughing_takes_the_depth_of_the_strategy_and_leaves_the_allowance(
    path_of: Callable[..., ToolPath],
) -> None:
    """From 30 mm in steps of 2 mm; 0.5 mm stay on the radius of 27 mm and at its wall."""
    levels = sorted({round(m.end[0], 6) for m in cuts(path_of("ROUGH CONTOUR"))}, reverse=True)
    assert {28.0, 26.0, 24.0, 22.0, 20.0, 18.0, 16.0} <= set(levels)
    assert 27.5 in levels
    assert 15.5 in levels


def test_roughing_never_comes_nearer_than_the_allowance(
    path_of: Callable[..., ToolPath],
) -> None:
    path = path_of("ROUGH CONTOUR")
    assert min(m.end[2] for m in path.moves) == pytest.approx(-109.5)


def test_the_finish_follows_the_drawing(path_of: Callable[..., ToolPath]) -> None:
    """The tip touches both seats, stops in both corners and turns around both edges."""
    ends = [(round(m.end[0], 4), round(m.end[2], 4)) for m in cuts(path_of("FINISH CONTOUR"))]
    for spot in [(15.0, -40.0), (19.2, -40.0), (20.0, -40.8), (27.0, -110.0)]:
        assert spot in ends


def test_arcs_around_edges_have_the_radius_of_the_nose(
    path_of: Callable[..., ToolPath],
) -> None:
    arcs = [m.arc for m in path_of("FINISH CONTOUR").moves if m.arc]
    assert [(a.centre[0] + 0.8, a.centre[2] + 0.8) for a in arcs] == [
        pytest.approx(edge) for edge in [(15.0, -1.5), (20.0, -40.0), (27.0, -80.0)]
    ]


def test_a_face_is_cut_past_the_axis_by_the_nose(path_of: Callable[..., ToolPath]) -> None:
    """Bar to z = 2 mm, 1.5 mm deep, 0.5 mm stay; the tip goes to −0.8 mm."""
    (move,) = cuts(path_of("ROUGH FACE"))
    assert move.end == pytest.approx((-0.8, 0.0, 0.5))
    move = cuts(path_of("FINISH FACE"))[-1]
    assert move.end == pytest.approx((-0.8, 0.0, 0.0))


def test_to_and_fro_cuts_in_both_directions(path_of: Callable[..., ToolPath]) -> None:
    edit = ("UNIDIRECTIONAL_TURNING(1.,.T.,(2.),$,#504,#501,#502,#506,1.,$,$)",
            "BIDIRECTIONAL_TURNING(1.,.T.,(2.),$,#504,$,$)")  # fmt: skip
    path = path_of("ROUGH CONTOUR", edit)
    runs = [m.end[2] - a[2] for a, m in path.segments() if m.type is MoveType.CONTACT]
    assert min(runs) < -10.0
    assert max(runs) > 10.0


def test_a_falling_wall_that_the_edge_cannot_follow_stays_and_is_said(
    path_of: Callable[..., ToolPath],
) -> None:
    """The roughing tool has 180 − 95 − 80 = 5 degrees behind its nose."""
    edits = (("CARTESIAN_POINT('',(22.,0.,-80.))", "CARTESIAN_POINT('',(16.,0.,-80.))"),)
    path = path_of("ROUGH CONTOUR", *edits)
    assert "cannot reach" in str(path.findings)


def test_a_feed_of_the_strategy_counts_for_its_move(path_of: Callable[..., ToolPath]) -> None:
    edit = (
        "#504,#501,#502,#506,1.,$,$);\n#353",
        "#504,#501,#502,#506,1.,FEED_PER_REV_TYPE(1.),FEED_VELOCITY_TYPE(0.01));\n#353",
    )
    feeds = {m.feed for m in path_of("ROUGH CONTOUR", edit).moves if m.feed}
    assert {feed.per_revolution for feed in feeds} == {None, 1.0}
    assert {feed.velocity for feed in feeds} == {None, 10.0}


def test_a_rounded_edge_is_one_arc_from_its_very_start(
    path_of: Callable[..., ToolPath],
) -> None:
    """Radius 3 mm about (17, −43); the centre of the nose runs at 3.8 mm."""
    edits = (
        ("#43,(#110,#120),#203", "#43,(#600),#203"),
        (
            "ENDSEC;\nEND-",
            "#600=REVOLVED_ROUND('R',#30,(),#601,#505,17.,#603);\n"
            "#601=AXIS2_PLACEMENT_3D('',#602,#501,#502);\n"
            "#602=CARTESIAN_POINT('',(0.,0.,-43.));\n"
            "#603=PARTIAL_CIRCULAR_PROFILE($,#604,90.);\n"
            "#604=TOLERANCED_LENGTH_MEASURE(3.,#510);\nENDSEC;\nEND-",
        ),
    )
    arcs = [(a, m) for a, m in path_of("FINISH CONTOUR", *edits).segments() if m.arc]
    start, end = arcs[0][0], arcs[-1][1].end
    assert start == pytest.approx((17.0 - 0.8, 0.0, -40.0), abs=1e-6)
    assert end == pytest.approx((20.0, 0.0, -43.8), abs=1e-6)
