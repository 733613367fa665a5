"""Constant surface speed: where the spindle goes with the radius, and how long that takes."""

from dataclasses import replace
from math import cos, pi, sin

import numpy as np
import pytest
from scipy.integrate import quad

from simulator.machine.acts import (
    MoveStretch,
    SpindleReached,
    SpindleTo,
)
from simulator.machine.interpreter import PIECE
from simulator.spec import Machine
from stepnc_model.post import blocks as nc
from stepnc_model.toolpath.path import Arc, ArcPlane
from tests.simulator.machine.test_interpreter import (
    PER_REVOLUTION,
    SURFACE,
    kinds,
    seconds,
    steps,
    stretches,
)


def facing(lathe: Machine, start: float, end: float) -> MoveStretch:
    (_, face) = stretches(
        steps(
            lathe,
            nc.Rapid(end=(start, 0.0, 5.0)),
            SURFACE,
            nc.Rapid(end=(start, 0.0, 0.0)),
            nc.Linear(end=(end, 0.0, 0.0), rate=PER_REVOLUTION),
        )
    )
    return face


def facing_time(start: float, end: float, fastest: float) -> float:
    """``∫ dx/(f·n)`` with ``n = min(v_c/(2π·|x|), n_max)``."""

    def inverse(x: float) -> float:
        return 1.0 / (0.2 * min(3000.0 / (2.0 * pi * max(abs(x), 1e-9)), fastest))

    bend = 3000.0 / (2.0 * pi * fastest)
    breaks = sorted(x for x in (-bend, bend) if min(start, end) < x < max(start, end))
    return abs(float(quad(inverse, start, end, points=breaks or None)[0]))


@pytest.mark.parametrize(
    ("start", "end"), [(60.0, 0.0), (60.0, 20.0), (20.0, 60.0), (40.0, -2.0), (-1.0, 30.0)]
)
def test_facing_at_constant_surface_speed_takes_the_integral(
    lathe: Machine, start: float, end: float
) -> None:
    face = facing(lathe, start, end)
    assert seconds([face]) == pytest.approx(facing_time(start, end, 60.0), rel=1e-6)
    wanted = np.minimum(60.0, 3000.0 / (2 * pi * np.abs(face.segments.end[:, 0]) + 1e-12))
    np.testing.assert_allclose(face.spindle_speed, wanted, rtol=1e-9)
    steps_of = np.abs(np.diff(np.log(face.spindle_speed)))
    assert steps_of.max() <= PIECE * (1.0 + 1e-9)
    assert set(face.segments.block.tolist()) == {4}


def test_surface_speed_keeps_the_limit_of_the_program(lathe: Machine) -> None:
    limited = replace(SURFACE, limit=12.0)
    found = steps(
        lathe,
        nc.Rapid(end=(60.0, 0.0, 0.0)),
        limited,
        nc.Linear(end=(0.0, 0.0, 0.0), rate=PER_REVOLUTION),
    )
    (face,) = stretches(found)
    assert face.spindle_speed.max() == 12.0
    assert seconds([face]) == pytest.approx(facing_time(60.0, 0.0, 12.0), rel=1e-6)


def test_surface_speed_turns_the_other_way(lathe: Machine) -> None:
    found = steps(
        lathe,
        nc.Rapid(end=(30.0, 0.0, 0.0)),
        replace(SURFACE, sense=nc.SpindleDirection.COUNTERCLOCKWISE),
        nc.Linear(end=(20.0, 0.0, 0.0), rate=PER_REVOLUTION),
    )
    (face,) = stretches(found)
    assert (face.spindle_speed < 0.0).all()
    assert (face.segments.speed > 0.0).all()


def test_spindle_goes_to_the_radius_of_a_rapid_and_is_waited_for(lathe: Machine) -> None:
    found = steps(
        lathe,
        nc.Rapid(end=(50.0, 0.0, 5.0)),
        SURFACE,
        nc.Rapid(end=(25.0, 0.0, 5.0)),
        nc.Linear(end=(25.0, 0.0, -5.0), rate=PER_REVOLUTION),
    )
    assert kinds(found) == [SpindleTo, SpindleTo, MoveStretch, SpindleReached, MoveStretch]
    speeds = [step.act.speed for step in found if isinstance(step.act, SpindleTo)]
    assert speeds == pytest.approx([3000 / (100 * pi), 3000 / (50 * pi)])


def test_surface_speed_of_a_first_feed_is_reached_first(lathe: Machine) -> None:
    found = steps(
        lathe,
        SURFACE,
        nc.Linear(end=(25.0, 0.0, 0.0), rate=PER_REVOLUTION),
        nc.Linear(end=(25.0, 0.0, -5.0), rate=PER_REVOLUTION),
    )
    assert kinds(found) == [SpindleTo, SpindleReached, MoveStretch]


@pytest.mark.parametrize("turn", [-pi, pi, 0.5 * pi])
def test_arc_at_constant_surface_speed_takes_the_integral(lathe: Machine, turn: float) -> None:
    """Of a semicircle both ends have the same radius, and the middle has not."""
    radius, centre = 15.0, 30.0

    def x(angle: float) -> float:
        # The first axis of ZX is z: the angle counts from it, and x is its sine.
        return centre + radius * sin(angle)

    end = (x(turn), 0.0, radius * cos(turn))
    found = steps(
        lathe,
        nc.Rapid(end=(centre, 0.0, radius)),
        SURFACE,
        nc.Circular(
            end=end,
            arc=Arc(centre=(centre, 0.0, 0.0), turn=turn, plane=ArcPlane.ZX),
            rate=PER_REVOLUTION,
        ),
    )
    (part,) = stretches(found)

    def time(angle: float) -> float:
        return radius / (0.2 * min(3000.0 / (2.0 * pi * x(angle)), 60.0))

    assert seconds([part]) == pytest.approx(abs(quad(time, 0.0, turn)[0]), rel=1e-3)
    assert np.abs(np.diff(np.log(np.abs(part.spindle_speed)))).max() <= 1.5 * PIECE
    assert part.segments.length.sum() == pytest.approx(radius * abs(turn))
