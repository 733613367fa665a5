"""The front holds exact optima, and none that another beats."""

from itertools import combinations
from pathlib import Path

import pytest

from optimiser.advice import Advice, ParetoPoint
from optimiser.modes import Free, Mode
from optimiser.optimise import optimise_program
from optimiser.planning.formulate import POINTS, OptimisationTask
from simulator.library import load_machine, match_material
from stepnc_model.programs.program import Program

PARTS = Path(__file__).parents[2] / "examples" / "parts"


def advice(name: str, *free: Free, mode: Mode = Mode.TC, tool_change: float = 0.0) -> Advice:
    program = Program.load(PARTS / "bracket.stpnc")
    plan = optimise_program(
        program,
        machine=load_machine("vmc15"),
        material=match_material(("C45",)),
        task=OptimisationTask(
            mode=mode, front=True, free=frozenset(free), tool_change=tool_change
        ),
        selected=lambda step: step.id == name,
    )
    return plan.advices[0]


def measures(point: ParetoPoint) -> tuple[float, float, float]:
    return point.state.time, point.state.roughness or 0.0, point.state.energy


@pytest.mark.parametrize("free", [(Free.FEED,), (Free.FEED, Free.DEPTH, Free.SPEED)])
def test_no_point_beats_another(free: tuple[Free, ...]) -> None:
    front = advice("FINISH CONTOUR", *free).front
    assert len(front) >= POINTS - 1
    for one, other in combinations(map(measures, front), 2):
        assert not all(a <= b for a, b in zip(one, other, strict=True))
        assert not all(b <= a for a, b in zip(one, other, strict=True))


def test_time_is_bought_with_roughness() -> None:
    front = advice("FINISH CONTOUR", Free.FEED).front
    times = [point.state.time for point in front]
    rough = [point.state.roughness or 0.0 for point in front]
    assert times == sorted(times)
    assert rough == sorted(rough, reverse=True)


def test_the_front_passes_through_the_advice() -> None:
    """At the Ra that the advice keeps, no point of the front is faster."""
    found = advice("FINISH CONTOUR", Free.FEED)
    assert found.after is not None
    assert found.after.roughness is not None
    finer = [
        point.state.time
        for point in found.front
        if (point.state.roughness or 0.0) <= found.after.roughness
    ]
    assert min(finer) >= found.after.time * (1.0 - 1e-9)


def test_where_the_feed_leaves_no_roughness_one_point_is_left() -> None:
    front = advice("DRILL HOLE 1", Free.FEED).front
    assert len(front) == 1


def test_the_front_holds_the_optimum_of_energy() -> None:
    """Two thin passes at a high feed: rougher than the fastest setting, and more frugal."""
    found = advice("MILL STEP", Free.FEED, Free.DEPTH, mode=Mode.EC)
    assert found.after is not None
    frugal = min(point.state.energy for point in found.front)
    assert frugal == pytest.approx(found.after.energy)


@pytest.mark.parametrize(
    ("name", "seconds"), [("ROUGH CONTOUR", 600.0), ("FINISH POCKET", 3000.0)]
)
def test_tool_life_counts_in_the_front_too(name: str, seconds: float) -> None:
    """With tool changes the best speed lies inside its range, down to the finest surface."""
    found = advice(name, *Free, tool_change=seconds)
    assert found.after is not None
    least = min(point.state.time for point in found.front)
    assert least <= found.after.time * (1.0 + 1e-6)
