"""What canonical commands come to."""

from stepnc_model.post.canonical import Canonical, read
from tests.every_case import every_case
from tests.stepnc_model.post.trace import difference, trace


def of(*lines: str) -> list[Canonical]:
    return list(read(lines))


FEED = "STRAIGHT_FEED(1, 0, 0)"


def test_the_order_of_settings_does_not_matter() -> None:
    one = of("FLOOD_ON()", "SET_FEED_RATE(5)", FEED)
    other = of("SET_FEED_RATE(9)", "SET_FEED_RATE(5)", "FLOOD_ON()", "FLOOD_ON()", FEED)
    assert difference(one, other) == ""


@every_case(
    "change",
    [
        "SET_FEED_RATE(5.1)",
        "FLOOD_ON()",
        "SET_FEED_MODE(1)",
        "START_SPINDLE_CLOCKWISE()",
        "STRAIGHT_TRAVERSE(0, 0, 1)",
        "DWELL(1)",
        "PROGRAM_STOP()",
        "CHANGE_TOOL(2)",
        "START_SPEED_FEED_SYNC(2)",
    ],
)
def test_every_change_shows(change: str) -> None:
    one = of("SET_FEED_RATE(5)", FEED)
    other = of("SET_FEED_RATE(5)", change, FEED)
    assert difference(one, other).startswith("event 0")


def test_speeds_do_not_matter_while_the_spindle_stands() -> None:
    assert difference(of(FEED), of("SET_SPINDLE_SPEED(100)", FEED)) == ""


def test_a_tool_change_stops_the_spindle() -> None:
    one = of("START_SPINDLE_CLOCKWISE()", "CHANGE_TOOL(1)", FEED)
    assert difference(one, of("CHANGE_TOOL(1)", FEED)) == ""


def test_motions_that_lead_nowhere_are_none() -> None:
    assert difference(of(FEED), of(FEED, FEED, "STRAIGHT_TRAVERSE(1, 0, 0)", "DWELL(0)")) == ""


def test_several_turns_are_single_ones() -> None:
    """From (0, 0, 0) about (5, 0): two full turns of 1 mm each, then half a turn of 0.5."""
    helix = of("ARC_FEED(10, 0, 5, 0, 3, 2.5)")
    single = of(
        "ARC_FEED(0, 0, 5, 0, 1, 1)",
        "ARC_FEED(0, 0, 5, 0, 1, 2)",
        "ARC_FEED(10, 0, 5, 0, 1, 2.5)",
    )
    assert difference(helix, single) == ""
    assert difference(of("ARC_FEED(10, 0, 5, 0, -1, 0)"), of("ARC_FEED(10, 0, 5, 0, 1, 0)"))


def test_a_missing_end_shows() -> None:
    assert difference(of(FEED), of(FEED, "PROGRAM_END()")).endswith("speeds=())")


def test_a_thread_has_its_lead_instead_of_a_feed() -> None:
    (event,) = trace(of("START_SPEED_FEED_SYNC(1.5)", "STRAIGHT_FEED(0, 0, -5)"))
    assert (event.kind, event.numbers) == ("thread", (0.0, 0.0, -5.0, 1.5))


def test_tolerances_are_honoured() -> None:
    near = of("STRAIGHT_FEED(1.0009, 0, 0)")
    assert difference(of(FEED), near, length=1e-3) == ""
    assert difference(of(FEED), near, length=1e-4)
