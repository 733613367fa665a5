"""Tool paths with planned feeds: factors, what is left out, and why."""

from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stepnc_model.editing.file_profile import FileProfile
from stepnc_model.part21.reader import Part21File
from stepnc_model.post.block_feeds import BlockPart, Numbered
from stepnc_model.post.blocks import Block, Circular, Linear
from stepnc_model.post.neutral import blocks_of
from stepnc_model.post.planned_paths import PlannedPaths, planned_paths
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.arc import length
from stepnc_model.toolpath.explicit.path_writer import write_paths
from stepnc_model.toolpath.explicit.planned_path import PlannedMove
from stepnc_model.toolpath.generate import generate
from stepnc_model.toolpath.path import Function, Move, MoveType, Point, ToolPath

PARTS = Path(__file__).parents[3] / "examples" / "parts"
Items = tuple[ToolPath | Function, ...]


def program(name: str, *changes: tuple[bytes, bytes]) -> Program:
    data = (PARTS / f"{name}.stpnc").read_bytes()
    for before, after in changes:
        assert before in data, before
        data = data.replace(before, after)
    return Program(Part21File.from_bytes(data))


def numbered(source: Program, items: Items) -> list[Numbered]:
    return list(enumerate(blocks_of(source, items, name="P"), 1))


def planned(
    source: Program, parts: Callable[[Linear | Circular], tuple[BlockPart, ...]]
) -> PlannedPaths:
    """Paths at new feeds for each line and arc."""
    items = tuple(generate(source))
    blocks = numbered(source, items)
    feeds = {
        number: parts(block)
        for number, block in blocks
        if isinstance(block, (Linear, Circular))
    }
    return planned_paths(source, items, blocks, feeds)


def halved(block: Linear | Circular) -> tuple[BlockPart, ...]:
    """Half the feed in the first quarter."""
    rate = block.rate.value
    return BlockPart(end=0.25, rate=0.5 * rate), BlockPart(end=1.0, rate=rate)


def fed_moves(found: PlannedPaths) -> list[PlannedMove]:
    return [
        step
        for path in found.paths
        for step in path.steps
        if isinstance(step, PlannedMove) and step.parts
    ]


@pytest.mark.parametrize("name", ["paper002", "paper003_pocket"])
def test_parts_are_factors_on_the_feed_of_the_technology(name: str) -> None:
    moves = [move for move in fed_moves(planned(program(name), halved)) if move.move.feed]
    assert moves
    for move in moves:
        if move.move.feed and not move.move.feed.is_plunge:
            assert [part.end for part in move.parts] == [0.25, 1.0]
            assert [part.factor for part in move.parts] == pytest.approx([0.5, 1.0])


@settings(max_examples=40)
@given(ratio=st.floats(1e-4, 50.0))
def test_no_factor_gives_more_than_the_planned_feed(ratio: float) -> None:
    source = program("paper002")
    rates = [
        block.rate.value
        for _, block in numbered(source, tuple(generate(source)))
        if isinstance(block, Linear)
    ]
    found = planned(source, lambda block: (BlockPart(end=1.0, rate=ratio * block.rate.value),))
    for move in fed_moves(found):
        (part,) = move.parts
        assert part.factor * rates[0] <= ratio * rates[0]
        assert part.factor == pytest.approx(ratio)


def test_a_stroke_with_overcut_is_a_contact() -> None:
    """One block makes the stroke and its overcut through air."""
    longest = max(
        fed_moves(planned(program("paper002"), halved)), key=lambda each: abs(each.move.end[1])
    )
    assert longest.move.type is MoveType.CONTACT


@pytest.mark.parametrize("profile", FileProfile)
@pytest.mark.parametrize("name", ["bracket", "shaft"])
def test_written_paths_lead_along_the_same_way(name: str, profile: FileProfile) -> None:
    """Lines, arcs and helices of all workingsteps come back, with half the feed at first."""
    source = program(name)
    found = planned(source, halved)
    written = Program(
        Part21File.from_bytes(write_paths(source, found.paths, profile)), units=source.units
    )
    given = {path.id: path for path in generate(source) if isinstance(path, ToolPath)}
    back = {path.id: path for path in generate(written) if isinstance(path, ToolPath)}
    assert len(found.paths) > 4
    for path in found.paths:
        one, other = given[path.step.id], back[path.step.id]
        assert other.start == pytest.approx(one.start)
        assert other.end == pytest.approx(one.end)
        whole = [sum(length(at, move) for at, move in each.segments()) for each in (one, other)]
        assert whole[1] == pytest.approx(whole[0], rel=1e-4)
        assert other.findings in ((), one.findings)
        cuts = [sum(_size(at, move) for at, move in each.segments()) for each in (one, other)]
        assert cuts[1] == pytest.approx(cuts[0], rel=1e-4)
        slow = sum(
            length(at, move) for at, move in other.segments() if move.feed and _is_slow(move)
        )
        quick = sum(length(at, move) for at, move in other.segments() if move.feed)
        assert slow >= 0.25 * quick - 1e-6


def _size(at: Point, move: Move) -> float:
    """Length of a move at feed, mm."""
    return length(at, move) if move.feed is not None else 0.0


def _is_slow(move: Move) -> bool:
    return move.feed is not None and move.feed.ratio < 0.75


def test_a_path_without_planned_feeds_is_left_out() -> None:
    found = planned_paths(program("paper002"), (), [], {})
    assert found == PlannedPaths(paths=(), findings=())
    source = program("shaft")
    items = tuple(generate(source))
    assert planned_paths(source, items, numbered(source, items), {}).paths == ()


def test_a_feed_per_revolution_of_a_lathe_has_factors_too() -> None:
    found = planned(program("shaft"), halved)
    assert [path.step.id for path in found.paths] == [
        "ROUGH FACE",
        "FINISH FACE",
        "ROUGH CONTOUR",
        "FINISH CONTOUR",
        "THREAD RELIEF",
    ]


def test_a_shared_operation_cannot_hold_two_paths() -> None:
    step = b"#3=MACHINING_WORKINGSTEP('ROUGH THE FACE',#22,#30,#40,$);"
    again = step.replace(b"#3=", b"#4=").replace(b"ROUGH", b"AGAIN")
    source = program(
        "paper002", (b"(#3),$,#20,$", b"(#3,#4),$,#20,$"), (step, step + b"\n" + again)
    )
    found = planned(source, halved)
    assert found.paths == ()
    assert [str(finding) for finding in found.findings] == [
        f"note: line 54: #40 PLANE_ROUGH_MILLING: '{name}': its tool path is not written: "
        "2 workingsteps share the operation"
        for name in ("ROUGH THE FACE", "AGAIN THE FACE")
    ]


def test_a_pattern_would_repeat_the_path_at_each_place() -> None:
    pattern = (
        b"#60=GENERAL_PATTERN('TWO',#10,(),#24,#30,(#61));\n"
        b"#61=AXIS2_PLACEMENT_3D('',#62,$,$);\n#62=CARTESIAN_POINT('',(20.,0.,3.));\nENDSEC;\nEND"
    )
    source = program(
        "paper002", (b"FACE',#22,#30,#40,$", b"FACE',#22,#60,#40,$"), (b"ENDSEC;\nEND", pattern)
    )
    found = planned(source, halved)
    assert found.paths == ()
    assert "repeat it at each of the 2 places" in found.findings[0].message


def test_a_missing_block_is_a_finding() -> None:
    source = program("paper002")
    items = tuple(generate(source))
    blocks = numbered(source, items)
    last = max(number for number, block in blocks if isinstance(block, Linear))
    kept: list[tuple[int, Block]] = [row for row in blocks if row[0] != last]
    feeds = {
        number: (BlockPart(end=1.0, rate=1.0),)
        for number, block in kept
        if isinstance(block, Linear)
    }
    found = planned_paths(source, items, kept, feeds)
    assert found.paths == ()
    assert "its moves and blocks do not match" in found.findings[0].message
