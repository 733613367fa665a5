from pathlib import Path

import numpy as np
import pytest

from service.simulation.run import simulate, waiting_machine
from simulator.machine.interpreter import interpret
from simulator.plant.course import NominalCourse, course_of
from tests.asking import asked_simulation
from tests.simulator.plant.courses import course, levels

SAMPLE = Path("examples/parts/paper002.stpnc")
REQUEST = asked_simulation(file=SAMPLE, machine="vmc15", material="c45")


@pytest.fixture(scope="module")
def milled() -> NominalCourse:
    prepared, virtual = waiting_machine(*REQUEST)
    return course_of(virtual.run(interpret(prepared.blocks, virtual.machine)), virtual.machine)


def test_a_course_takes_the_time_of_the_virtual_machine(milled: NominalCourse) -> None:
    whole = simulate(*REQUEST).whole
    assert milled.duration == pytest.approx(whole.duration, rel=1e-12)
    widths = np.diff(milled.until, prepend=0.0)
    assert float(widths @ milled.removal_rate) == pytest.approx(whole.volume, rel=2e-3)
    assert float(milled.force.max()) == pytest.approx(whole.force.value, rel=1e-3)


def test_rapids_and_waits_cannot_be_overridden(milled: NominalCourse) -> None:
    assert (milled.programmed[milled.can_override] > 0.0).all()
    assert (milled.force[~milled.can_override] == 0.0).all()
    widths = np.diff(milled.until, prepend=0.0)
    assert widths[milled.can_override].max() <= 0.01 + 1e-12


def test_force_over_feed_has_the_exponent_of_kienzle(milled: NominalCourse) -> None:
    cuts = milled.force > 0.0
    # C45 in the library: m_c = 0.22.
    np.testing.assert_allclose(milled.exponent[cuts], 0.78, rtol=1e-6)


def test_the_peak_over_the_mean_is_that_of_the_arc(milled: NominalCourse) -> None:
    # Full slots with four teeth: those at 45° and 135° pull the same way across the feed and
    # against each other along it, √2·sin 45° and the radial share of it, over 4/π.
    cuts = (milled.force > 0.99 * milled.force.max()) & milled.can_override
    np.testing.assert_allclose(milled.peak[cuts], np.hypot(1.0, 0.3) * np.pi / 4.0, rtol=0.04)
    assert (milled.wall[cuts] > 0.0).all()
    assert (milled.wall <= milled.peak * 1.01).all()
    assert (milled.peak > 0.0).all()
    assert (milled.peak[~milled.can_override] == 1.0).all()
    assert (milled.wall[~milled.can_override] == 0.0).all()


def test_the_upper_end_of_the_edges_lags_by_the_helix(milled: NominalCourse) -> None:
    # 30° are half a revolution in 5.4 diameters.
    cuts = (milled.force > 0.0) & (milled.diameter > 0.0)
    lag = 2.0 * np.tan(np.pi / 6.0) / milled.diameter[cuts] * milled.axial_depth[cuts]
    np.testing.assert_allclose(milled.lag[cuts], lag, rtol=1e-5)


def test_nothing_is_no_course() -> None:
    with pytest.raises(ValueError, match="nothing that takes time"):
        course_of([], waiting_machine(*REQUEST)[1].machine)


def test_cells_must_ascend() -> None:
    good = course(levels(1.0))
    names = NominalCourse.__dataclass_fields__
    columns = {name: getattr(good, name) for name in names}
    with pytest.raises(ValueError, match="ascend"):
        NominalCourse(**{**columns, "until": columns["until"][::-1]})
    with pytest.raises(ValueError, match="rows"):
        NominalCourse(**{**columns, "teeth": columns["teeth"][:-1]})
