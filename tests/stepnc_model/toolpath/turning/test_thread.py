"""Threads against ISO 68-1 and the drawing of the shaft."""

from collections.abc import Callable

import pytest

from stepnc_model.errors import SchemaError
from stepnc_model.post.neutral import unsplit
from stepnc_model.toolpath.path import Move, MoveType, Point, ToolPath


def cuts(path: ToolPath) -> list[Move]:
    return [move for move in path.moves if move.type is MoveType.CONTACT]


def runs(path: ToolPath) -> list[tuple[Point, Point]]:
    """Start and end of each run bound to the spindle."""
    bound = [(a, m.end) for a, m in path.segments() if m.feed and m.feed.is_synchronised]
    starts = [a for a, _ in bound if a not in [end for _, end in bound]]
    ends = [end for _, end in bound if end not in [a for a, _ in bound]]
    return list(zip(starts, ends, strict=True))


LIST = "(0.434,0.18,0.138,0.116,0.102,0.093,0.085,0.079)"
NAME = "THREAD M30 X 2"


def bottoms(path: ToolPath) -> list[float]:
    return [m.end[0] for m in cuts(path)]


def test_depths_are_those_of_the_list(path_of: Callable[..., ToolPath]) -> None:
    found = bottoms(path_of(NAME))
    assert found[:2] == pytest.approx([15.0 - 0.434, 15.0 - 0.614])
    assert found[-1] == pytest.approx(15.0 - 1.227)
    assert len(found) == 8


def test_without_depths_the_thread_is_as_deep_as_its_standard_says(
    path_of: Callable[..., ToolPath],
) -> None:
    """0.61343 · 2 mm; equal chip areas: the first pass takes 1/√8 of it."""
    found = bottoms(path_of(NAME, (LIST, "()")))
    assert found[-1] == pytest.approx(15.0 - 0.61343 * 2.0, abs=1e-4)
    assert 15.0 - found[0] == pytest.approx(0.61343 * 2.0 / 8.0**0.5, abs=1e-4)


def test_even_depths_are_even(path_of: Callable[..., ToolPath]) -> None:
    edits = ((LIST, "(0.4)"), ("CONSTANT_REMOVAL_AMOUNT", "CONSTANT_DEPTH"))
    depths = [15.0 - x for x in bottoms(path_of(NAME, *edits))]
    steps = [b - a for a, b in zip([0.0, *depths], depths, strict=False)]
    assert steps == pytest.approx([depths[-1] / 4.0] * 4)


def test_passes_are_bound_to_the_spindle(path_of: Callable[..., ToolPath]) -> None:
    for move in cuts(path_of(NAME)):
        assert move.feed is not None
        assert move.feed.is_synchronised
        assert move.feed.per_revolution == 2.0


def test_run_in_is_two_pitches_and_run_out_ends_in_the_relief(
    path_of: Callable[..., ToolPath],
) -> None:
    found = runs(path_of(NAME))
    assert found[-1][0][2] == pytest.approx(4.0)
    assert {end[2] for _, end in found} == {-27.0}


def test_the_right_flank_stays_where_it_is(path_of: Callable[..., ToolPath]) -> None:
    """Fed in along a flank of 30 degrees: z of the tip less depth times tan 30."""
    starts = [start for start, _ in runs(path_of(NAME))]
    flanks = [z + (15.0 - x) * 3.0**-0.5 for x, _, z in starts]
    assert flanks == pytest.approx([flanks[0]] * 8, abs=1e-3)


def test_a_left_hand_thread_is_cut_away_from_the_chuck(
    path_of: Callable[..., ToolPath],
) -> None:
    edit = ("#431,.RIGHT.,2.,\n     .RIGHT.", "#431,.RIGHT.,2.,\n     .LEFT.")
    found = runs(path_of(NAME, edit))
    assert len(found) == 8
    assert all(end[2] > start[2] for start, end in found)


def test_without_relief_it_is_said(path_of: Callable[..., ToolPath]) -> None:
    path = path_of(NAME, ("(#14,#15)", "(#15)"))
    assert "no relief" in str(path.findings)


def test_an_inside_thread_is_refused(path_of: Callable[..., ToolPath]) -> None:
    with pytest.raises(SchemaError, match="internal threads are not supported"):
        path_of(NAME, (".EXTERNAL.", ".INTERNAL."))


def test_contact_is_what_cuts_and_the_rest_of_the_run_is_air(
    path_of: Callable[..., ToolPath],
) -> None:
    """The last pass at 13.773 mm: from the chamfer of 45° at the front to the relief."""
    path = path_of(NAME)
    last = [(a, m) for a, m in path.segments() if m.feed and m.feed.is_synchronised][-3:]
    air, contact = MoveType.NO_CONTACT, MoveType.CONTACT
    assert [m.type for _, m in last] == [air, contact, air]
    assert last[1][0][2] == pytest.approx(-0.273, abs=1e-9)
    assert last[1][1].end[2] == pytest.approx(-25.0, abs=1e-6)
    assert len({m.feed for _, m in last}) == 1


def test_the_parts_of_a_run_are_one_block_of_a_control(
    path_of: Callable[..., ToolPath],
) -> None:
    path = path_of(NAME)
    moves = [step for step in unsplit(path.start, path.steps) if isinstance(step, Move)]
    assert sum(m.feed is not None and m.feed.is_synchronised for m in moves) == 8


def test_without_relief_it_leaves_at_the_feed_and_in_contact(
    path_of: Callable[..., ToolPath],
) -> None:
    path = path_of(NAME, ("(#14,#15)", "(#15)"))
    for _, end in runs(path):
        leaving = next(m for a, m in path.segments() if a == end)
        assert leaving.type is MoveType.CONTACT
        assert leaving.feed is not None
        assert leaving.end[2] == end[2] == -25.0


def test_at_a_shoulder_the_insert_stops_short_by_half_a_pitch(
    path_of: Callable[..., ToolPath],
) -> None:
    """The thread reaches to the seat of 40 mm at −40 mm; the pitch is 2 mm."""
    edits = (("#142=TOLERANCED_LENGTH_MEASURE(25.", "#142=TOLERANCED_LENGTH_MEASURE(40."),)
    path = path_of(NAME, *edits, ("(#14,#15)", "(#15)"))
    assert runs(path)[-1][1][2] == pytest.approx(-39.0)
    assert "before the shoulder" in str(path.findings)


def test_a_run_in_keeps_half_the_insert_off_the_wall_of_the_relief(
    path_of: Callable[..., ToolPath],
) -> None:
    """Away from the chuck out of a relief from −29 to −25 mm; half a pitch is 1 mm."""
    path = path_of(NAME, ("#431,.RIGHT.,2.,\n     .RIGHT.", "#431,.RIGHT.,2.,\n     .LEFT."))
    assert runs(path)[-1][0][2] == pytest.approx(-28.0)
    assert "the run-in is 3 mm instead of 4 mm" in str(path.findings)
