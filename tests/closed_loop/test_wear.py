"""Wear and hardness in the whole loop: each is told for what it is."""

from math import inf

import pytest

from controller.guard import OverrideBand
from controller.orders import EventKind
from controller.states.loop_settings import LoopSettings
from simulator.plant.hidden_behaviour import HiddenChange, HiddenQuantity, HiddenTruth
from tests.closed_loop.rig import SET_POINT, Rig, reference, rig, step
from tests.closed_loop.test_disturbances import cut, kinds
from tests.simulator.plant.courses import course

QUICK = 0.15 / 60.0
"""mm/s; took the override to its floor and was called harder work"""

FLOOR, LEAST = 0.6, 0.3

STEPS = [step(reference(floor=FLOOR))]


def run(hidden: HiddenTruth, *, seconds: float, seed: int = 0) -> Rig:
    """A long cut at nine tenths of its set point."""
    path = course(cut(0.9 * SET_POINT, cells=round(100 * seconds)))
    settings = LoopSettings(look_ahead=0, band=OverrideBand())
    return rig(path, hidden, steps=STEPS, settings=settings, seed=seed).run(seconds)


@pytest.mark.parametrize("seed", range(2))
def test_wear_is_told_as_wear_and_asks_for_another_tool(seed: int) -> None:
    done = run(HiddenTruth(wear_rate=QUICK), seconds=200.0, seed=seed)
    told = kinds(done)
    assert told[EventKind.HARDNESS] == 0
    life = done.loop.state.monitor.life
    assert life is not None
    assert life.flank_wear == pytest.approx(done.machine.truth.flank_wear, abs=0.03)
    # At rest it never feeds less than the least feed, until it holds the program for good.
    cutting = [each.allowed.override for each in done.cycles if each.reading.time > 3.0]
    assert min(each for each in cutting if each > 0.0) >= FLOOR * (1.0 - 1e-9)
    assert done.loop.state.is_stopped
    (stop,) = done.told(EventKind.STOP)
    assert "change the tool" in stop.text
    assert "harder" not in stop.text
    over = [each for each in done.cycles if each.over.is_lasting]
    assert 0.0 < sum(each.reading.period for each in over) < 15.0


@pytest.mark.parametrize("seed", range(4))
def test_harder_work_is_never_told_as_wear(seed: int) -> None:
    jump = HiddenChange(time=30.0, what=HiddenQuantity.HARDNESS, value=1.2)
    hidden = HiddenTruth(force_factor=1.2, changes=(jump,))
    done = run(hidden, seconds=60.0, seed=seed)
    told = kinds(done)
    assert (told[EventKind.HARDNESS], told[EventKind.WEAR], told[EventKind.STOP]) == (1, 0, 0)
    life = done.loop.state.monitor.life
    assert life is not None
    assert life.flank_wear < 0.03
    assert life.hardness == pytest.approx(1.44, rel=0.05)


def test_both_together_are_told_apart() -> None:
    jump = HiddenChange(time=40.0, what=HiddenQuantity.HARDNESS, value=1.25)
    done = run(HiddenTruth(wear_rate=0.3 * QUICK, changes=(jump,)), seconds=80.0)
    (change,) = done.told(EventKind.HARDNESS)
    assert change.time == pytest.approx(40.0, abs=1.0)
    life = done.loop.state.monitor.life
    assert life is not None
    assert life.flank_wear == pytest.approx(done.machine.truth.flank_wear, abs=0.02)
    assert life.hardness == pytest.approx(1.25, rel=0.05)


def test_while_the_loop_is_off_it_only_watches() -> None:
    path = course(cut(SET_POINT, cells=4000))
    hidden = HiddenTruth(flank_wear=0.0, wear_rate=4.0 * QUICK)
    settings = LoopSettings(look_ahead=0, is_on=False)
    done = rig(path, hidden, steps=STEPS, settings=settings).run(inf)
    assert {each.allowed.override for each in done.cycles} == {1.0}
    assert kinds(done)[EventKind.WEAR] == 1
    assert kinds(done)[EventKind.OVER] >= 1
    assert kinds(done)[EventKind.STOP] == 0
