"""Lechevalier et al. 2018, Fig. 11: ten parts of a batch, their settings and times.

The pocket has no printed dimension; that of ``paper003_pocket`` is fitted, one number for ten
times, by ``python -m benchmarks.paper003_batch``. Fig. 5 gives 60, 30, 20 and 30 s for batch
setup, part setup, part ejection and batch ejection.
"""

import csv
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from extras.factory.cycles import PartCycles
from service.programs.machine_choice import material_for
from simulator.library import load_machine
from stepnc_model.editing.cut_settings import CutSettings
from stepnc_model.programs.program import Program

EXAMPLES = Path(__file__).parents[2] / "examples"
MACHINE = load_machine("paper003")

Floats = NDArray[np.float64]

with (EXAMPLES / "paper003_fig11.csv").open(encoding="ascii") as file:
    ROWS = list(csv.DictReader(file))


def column(name: str) -> Floats:
    return np.array([float(row[name]) for row in ROWS])


FEED, SPEED, DEPTH = column("feed_m_s"), column("spindle_rev_s"), column("depth_mm")
SECONDS = column("machining_ms") / 1000.0


@pytest.fixture(scope="module")
def ours() -> Floats:
    program, cycles = Program.load(EXAMPLES / "parts" / "paper003_pocket.stpnc"), PartCycles()
    match = material_for("", program)
    return np.array([
        cycles.cycle(
            program,
            MACHINE,
            match,
            CutSettings(feed=1000.0 * feed, spindle_speed=speed, depth=depth),
        ).time
        for feed, speed, depth in zip(FEED, SPEED, DEPTH, strict=True)
    ])


def solved(seconds: Floats) -> tuple[Floats, Floats]:
    """Line of times over 1/feed and spindle speed, and its residuals."""
    matrix = np.stack([np.ones(len(FEED)), 1.0 / FEED, np.abs(SPEED)], axis=1)
    found, *_ = np.linalg.lstsq(matrix, seconds)
    return found, seconds - matrix @ found


def test_settings_lie_within_the_ranges_of_section_4_2() -> None:
    assert ((FEED >= 0.03) & (FEED <= 0.09)).all()
    assert (
        (2.0 * np.pi * np.abs(SPEED) >= 75.4) & (2.0 * np.pi * np.abs(SPEED) <= 226.2)
    ).all()
    assert (SPEED < 0.0).all()
    assert ((DEPTH >= 2.5) & (DEPTH <= 3.5)).all()


def test_machining_times_are_those_of_print_within_two_per_cent(ours: Floats) -> None:
    assert ours == pytest.approx(SECONDS, rel=0.02)
    assert np.sqrt(np.mean((ours - SECONDS) ** 2)) < 1.0


def test_lines_of_time_over_feed_are_alike(ours: Floats) -> None:
    (_, slope, _), _ = solved(SECONDS)
    (_, own, _), _ = solved(ours)
    assert own == pytest.approx(slope, rel=0.05)


def test_ramps_of_the_spindle_are_in_revolutions(ours: Floats) -> None:
    """At 10 rev/s² a start and a stop take 0.2 s per rev/s; at 10 rad/s² a start takes 0.63."""
    (_, _, printed), left = solved(SECONDS)
    (_, _, own), _ = solved(ours)
    assert own == pytest.approx(2.0 / 10.0, rel=1e-2)
    assert 0.1 <= printed <= 0.25
    assert np.sqrt(np.mean(left**2)) < 0.5


@pytest.mark.parametrize(
    ("name", "seconds"),
    [
        ("batch_setup_ms", 60.0),
        ("part_setup_ms", 30.0),
        ("part_ejection_ms", 20.0),
        ("batch_ejection_ms", 30.0),
    ],
)
def test_handling_times_scatter_within_ten_per_cent_of_figure_5(
    name: str, seconds: float
) -> None:
    """Once a batch for the batch; 0 in the other rows."""
    handling = MACHINE.handling
    assert handling is not None
    times = column(name) / 1000.0
    printed = times[times > 0.0]
    assert len(printed) == (10 if name.startswith("part") else 1)
    state = getattr(handling, name.removesuffix("_ms"))
    assert state.time == seconds
    assert np.abs(printed / seconds - 1.0).max() <= handling.time_scatter


def test_five_per_cent_would_not_hold_them() -> None:
    """Figures of `docs/papers.md`: -6.2 and +9.1 %."""
    share = column("part_ejection_ms") / 20_000.0 - 1.0
    assert (100.0 * share.min(), 100.0 * share.max()) == pytest.approx((-6.2, 9.1), abs=0.05)
