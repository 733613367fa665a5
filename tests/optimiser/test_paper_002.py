"""The optimum of paper 002's workingstep, against closed forms and its own procedure."""

from math import pi

import numpy as np
import pytest
from numpy.typing import NDArray

from optimiser.bounds.limits import limits_of, power_load, segment_at, spindle_limits
from optimiser.cuts.conditions import CuttingConditions
from optimiser.cuts.cut import Cut, CutKind
from optimiser.modes import Mode
from optimiser.solver.problem import Cost, LimitName, Problem, Setting
from optimiser.solver.workingstep import (
    solve,
    widened,
)
from simulator.library import load_machine, load_material
from simulator.physics.engagement import Engagement, bilateral, full_immersion, unidirectional
from simulator.spec import CuttingMaterial, ToolKind
from stepnc_model.programs.tool import Tool
from stepnc_model.units import speed_from_m_min
from tests.every_case import every_case

Floats = NDArray[np.float64]

# Ridwan, Xu and Liu 2010, Table 2.
DIAMETER = 18.0  # mm
DEPTH = 3.0  # mm
LENGTH = 300.0  # mm
RESISTANCE = 1000.0  # N/mm²
MOTOR = 290.0  # W
EFFICIENCY = 0.9
GREATEST_FEED = 0.5  # mm per tooth
VELOCITY = speed_from_m_min(35.0)
SPINDLE = VELOCITY / (pi * DIAMETER)
FORCE = 1000.0 * MOTOR * EFFICIENCY / VELOCITY  # N

TEETH = (1, 2, 3, 4, 6, 8)
ARCS = {
    "full": full_immersion(),
    "three quarters": unidirectional(13.5, DIAMETER),
    "half": unidirectional(9.0, DIAMETER),
    "half in the middle": bilateral(9.0, DIAMETER),
    "quarter": unidirectional(4.5, DIAMETER),
    "0.4 mm with four teeth": unidirectional(0.2929 * DIAMETER, DIAMETER),
}


def paper_problem(
    arc: Engagement, teeth: int, *, total: float = DEPTH, deepest: float | None = None
) -> Problem:
    """Table 2 with a number of passes that is free when a deepest one is given."""
    tool = Tool(id="mill", keyword="TAPERED_ENDMILL", diameter=DIAMETER, teeth=teeth)
    cut = Cut(
        kind=CutKind.MILLING,
        tool=tool,
        tool_kind=ToolKind.ENDMILL,
        diameter=DIAMETER,
        programmed=Setting(feed=0.05, depth=total, passes=1, speed=SPINDLE),
        length=LENGTH,
        total_depth=total,
        is_depth_free=deepest is not None,
        engagement=arc,
        depth_bound=deepest,
    )
    at = CuttingConditions(
        machine=load_machine("paper002"),
        material=load_material("paper002"),
        cutting_material=CuttingMaterial.HSS,
        grade=None,
        roughness=None,
    )
    return Problem(
        limits=limits_of(cut, at),
        cost=Cost(length=LENGTH, teeth=teeth, motor_power=power_load(cut, at)),
        total_depth=total,
        passes=(1, 1) if deepest is None else (1, 80),
        speeds=(SPINDLE,),
        programmed=cut.programmed,
        stretches=(spindle_limits(cut, at, segment_at(at, SPINDLE)),),
    )


def closed_form(arc: Engagement, teeth: int, depth: float = DEPTH) -> float:
    """2π·F_mt/(k_s·a·C·z), mm per tooth."""
    return 2.0 * pi * FORCE / (RESISTANCE * depth * arc.cosine_difference * teeth)


def stepped(
    arc: Engagement, teeth: int, *, step: float, total: float = DEPTH, deepest: float = DEPTH
) -> tuple[float, int] | None:
    """The paper's procedure: deepest cut, greatest feed, less feed until the motor can.

    Feed per tooth and number of passes; None when the steps lead past zero.
    """
    passes = 1
    while total / passes > deepest:
        passes += 1
    depth = total / passes
    for number in range(round(GREATEST_FEED / step)):
        feed = GREATEST_FEED - number * step
        force = RESISTANCE * depth * teeth * feed * arc.cosine_difference / (2.0 * pi)
        if force * VELOCITY / (1000.0 * EFFICIENCY) <= MOTOR:
            return feed, passes
    return None


@every_case("arc", ARCS.values())
@every_case("teeth", TEETH)
def test_paper_002_has_the_feed_of_the_closed_form(arc: Engagement, teeth: int) -> None:
    solution = solve(paper_problem(arc, teeth), Mode.TC)
    feed = closed_form(arc, teeth)
    if feed < GREATEST_FEED:
        assert solution.setting.feed == pytest.approx(feed, rel=1e-12)
        assert solution.active is LimitName.MOTOR_POWER
    else:
        assert solution.setting.feed == pytest.approx(GREATEST_FEED)
        assert solution.active is LimitName.FEED_PER_TOOTH


@every_case(
    ("teeth", "feed"),
    [(1, 0.4685), (2, 0.2343), (3, 0.1562), (4, 0.1171), (6, 0.0781), (8, 0.0586)],
)
def test_paper_002_at_full_immersion_runs_at_290_mm_min(teeth: int, feed: float) -> None:
    setting = solve(paper_problem(full_immersion(), teeth), Mode.TC).setting
    assert setting.feed == pytest.approx(feed, abs=6e-5)
    feed_mm_min = setting.feed * teeth * setting.speed * 60.0
    assert feed_mm_min == pytest.approx(290.0)


@every_case("arc", ARCS.values())
def test_paper_002_removes_15_660_mm3_a_minute_wherever_the_motor_holds(
    arc: Engagement,
) -> None:
    """N_c = k_s·MRR/60e6: the immersion does not matter; a_e = C·D/2."""
    setting = solve(paper_problem(arc, 6), Mode.TC).setting
    width = 0.5 * arc.cosine_difference * DIAMETER
    removal = width * DEPTH * setting.feed * 6 * setting.speed * 60.0
    assert removal == pytest.approx(15_660.0, rel=1e-9)


@every_case("arc", ARCS.values())
@every_case("teeth", TEETH)
@every_case("step", [0.1, 0.01, 0.001])
def test_stepped_procedure_never_beats_the_closed_form_and_ends_within_a_step(
    arc: Engagement, teeth: int, step: float
) -> None:
    best = solve(paper_problem(arc, teeth), Mode.TC).setting.feed
    found = stepped(arc, teeth, step=step)
    if found is None:
        assert best < step
        return
    assert best - step < found[0] <= best * (1.0 + 1e-12)


def test_steps_of_0_1_mm_give_table_1_with_one_tooth_and_nothing_with_eight() -> None:
    found = stepped(full_immersion(), 1, step=0.1)
    assert found is not None
    assert found[0] == pytest.approx(0.4)
    assert stepped(full_immersion(), 8, step=0.1) is None


@every_case("total", [2.0, 3.0, 7.0, 11.0, 30.0])
@every_case("deepest", [0.4, 1.0, 3.0])
@every_case("arc", [ARCS["full"], ARCS["quarter"]])
def test_stepped_procedure_with_passes_comes_within_its_step_for_constant_resistance(
    arc: Engagement, total: float, deepest: float
) -> None:
    """Time goes with passes over feed; both choose the passes themselves."""
    problem = paper_problem(arc, 4, total=total, deepest=deepest)
    best = solve(problem, Mode.TC)
    found = stepped(arc, 4, step=1e-4, total=total, deepest=deepest)
    assert found is not None
    feed, passes = found
    per_second = 4 * SPINDLE
    time = passes * LENGTH / (feed * per_second)
    assert best.time <= time * (1.0 + 1e-9)
    assert best.time > passes * LENGTH / ((feed + 1e-4) * per_second)


def test_twice_the_motor_power_is_twice_the_feed() -> None:
    """d ln f / d ln N = 1 at the power limit."""
    problem = paper_problem(full_immersion(), 4)
    before = solve(problem, Mode.TC)
    after = solve(widened(problem, LimitName.MOTOR_POWER, by_factor=2.0), Mode.TC)
    assert after.setting.feed == pytest.approx(2.0 * before.setting.feed)
    assert after.time == pytest.approx(0.5 * before.time)
