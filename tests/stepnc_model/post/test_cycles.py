"""Drilling cycles as single blocks."""

from stepnc_model.post.blocks import (
    DrillingCycle,
    Linear,
    Pause,
    Rapid,
    Rate,
    SpindleOff,
    SpindleOn,
    expanded,
)
from stepnc_model.toolpath.path import CycleKind

RATE = Rate(value=1.0)


def heights(
    kind: CycleKind, *, step: float = 0.0, retract: float = 0.0, dwell: float = 0.0
) -> list[object]:
    """Heights of feeds, ``^`` before those of rapids, and what else happens."""
    cycle = DrillingCycle(
        kind=kind,
        at=(1.0, 2.0),
        retract_z=3.0,
        bottom_z=-7.0,
        rate=RATE,
        step_depth=step,
        retract_distance=retract,
        dwell=dwell,
    )
    found: list[object] = []
    for block in expanded(cycle, SpindleOn(speed=1.0)).expansion:
        if isinstance(block, Linear):
            found.append(block.end[2])
        elif isinstance(block, Rapid):
            found.append(f"^{block.end[2]:g}")
        else:
            found.append(block)
    return found


def test_drilling_feeds_in_and_comes_out_in_rapid() -> None:
    assert heights(CycleKind.DRILL) == [-7.0, "^3"]


def test_a_dwell_is_at_the_bottom() -> None:
    assert heights(CycleKind.DWELL, dwell=0.5) == [-7.0, Pause(seconds=0.5), "^3"]


def test_pecks_come_out_and_go_back_above_the_last_depth() -> None:
    found = heights(CycleKind.PECK, step=4.0, retract=0.5)
    assert found == [-1.0, "^3", "^-0.5", -5.0, "^3", "^-4.5", -7.0, "^3"]


def test_breaking_chips_retracts_a_little() -> None:
    found = heights(CycleKind.CHIP_BREAK, step=5.0, retract=0.5)
    assert found == [-2.0, "^-1.5", -7.0, "^3"]


def test_a_step_that_divides_the_depth_has_no_empty_peck() -> None:
    assert heights(CycleKind.CHIP_BREAK, step=5.0) == [-2.0, "^-2", -7.0, "^3"]


def test_boring_feeds_out() -> None:
    assert heights(CycleKind.BORE) == [-7.0, 3.0]


def test_boring_with_a_stop_starts_the_spindle_again() -> None:
    found = heights(CycleKind.BORE_STOP)
    assert found == [-7.0, SpindleOff(), "^3", SpindleOn(speed=1.0)]
