"""Uncertainties are honest: what random logs show lies within them, place by place.

The truth of a log is what a dense one of the same path shows.
"""

from collections.abc import Callable
from math import cos, sin

import numpy as np
import pytest

from simulator.motion.segments import Floats, lines
from simulator.verification.deviation import SurfacePlaces, surface_places
from simulator.verification.logged import LoggedPart, LoggedSamples
from simulator.verification.path import ProgrammedRun, programmed_path
from simulator.verification.required import required_places
from simulator.verification.revolved import required_bar, required_turned_places
from simulator.verification.surface import programmed_part
from simulator.verification.turned import LoggedBar, turned_part, turned_places
from tests.simulator.verification import test_required, test_revolved
from tests.simulator.verification.block import sampled, samples_at
from tests.simulator.verification.meshes import revolved

Places = Callable[[LoggedSamples], SurfacePlaces]

CLOSE = 2e-3
"""Uncertainty of the truth itself, mm."""


def pocket_ring(x: float, y: float) -> list[tuple[float, float, float]]:
    """A ring of the cutter, with corners rounded by 1 mm in lines of a twentieth of a turn."""
    found = []
    for sx, sy, begin in ((1, 1, 0.0), (-1, 1, 0.5), (-1, -1, 1.0), (1, -1, 1.5)):
        middle = (20.0 + sx * (x - 1.0), 15.0 + sy * (y - 1.0))
        for turn in (np.pi * (begin + np.linspace(0.0, 0.5, 6))).tolist():
            found.append((middle[0] + cos(turn), middle[1] + sin(turn), -5.0))  # noqa: PERF401
    return [*found, found[0]]


POCKET = ((20.0, 15.0, 5.0), (20.0, 15.0, -5.0), *pocket_ring(4.0, 2.0), *pocket_ring(8.5, 4.5),
          *pocket_ring(9.0, 5.0), (20.0, 15.0, -5.0), (20.0, 15.0, 5.0))  # fmt: skip
"""Rings that clear the pocket; the last takes the half millimetre that is left."""

MILLED = programmed_part(
    programmed_path([
        ProgrammedRun(
            cutter=test_required.CUTTER, tool=1, workingstep=0,
            segments=lines([list(point) for point in POCKET], speed=5.0),
        )
    ]),
    test_required.STOCK,
    cell=0.25,
)  # fmt: skip
TURNED = turned_part(
    programmed_path([
        ProgrammedRun(
            cutter=test_revolved.INSERT, tool=1, workingstep=0,
            segments=lines([list(point) for point in test_revolved.WAY], speed=5.0),
        )
    ]),
    test_revolved.BAR,
)  # fmt: skip
BAR = required_bar(revolved(test_revolved.PROFILE), test_revolved.BAR)


def milled(samples: LoggedSamples) -> SurfacePlaces:
    left = LoggedPart(MILLED, test_required.STOCK, {1: test_required.CUTTER})
    left.add(samples)
    return surface_places(MILLED, left)


def milled_required(samples: LoggedSamples) -> SurfacePlaces:
    left = LoggedPart(test_required.PART, test_required.STOCK, {1: test_required.CUTTER})
    left.add(samples)
    return required_places(test_required.PART, left)


def turned(samples: LoggedSamples) -> SurfacePlaces:
    left = LoggedBar(TURNED.bar, test_revolved.BAR, {1: test_revolved.INSERT})
    left.add(samples)
    return turned_places(TURNED, left)


def turned_required(samples: LoggedSamples) -> SurfacePlaces:
    left = LoggedBar(BAR.bar, test_revolved.BAR, {1: test_revolved.INSERT})
    left.add(samples)
    return required_turned_places(BAR, left)


def log_of(
    way: tuple[tuple[float, float, float], ...], random: np.random.Generator, offset: Floats
) -> LoggedSamples:
    """A log with random rate, phase, rounding, jitter of its stamps and missing samples."""
    step = float(random.choice([0.04, 0.1, 0.4, 1.1]))
    points = sampled(way, step)[int(random.integers(0, 3)) :] + offset
    decimals = int(random.choice([3, 4, 6]))
    samples = samples_at(np.round(points, decimals))
    jitter = 0.01 * random.uniform(-0.4, 0.4, len(points)) * random.integers(0, 2)
    kept = random.uniform(size=len(points)) > 0.05 * random.integers(0, 2)
    kept[0] = kept[-1] = True
    return LoggedSamples(
        time=(samples.time + jitter)[kept], position=samples.position[kept],
        tool=samples.tool[kept], workingstep=samples.workingstep[kept],
    )  # fmt: skip


CASES = [
    (POCKET, milled),
    (test_required.pocket_way(), milled_required),
    (test_revolved.WAY, turned),
    (test_revolved.WAY, turned_required),
]
NAMES = ["milled", "milled required", "turned", "turned required"]


@pytest.mark.parametrize(("way", "places_of"), CASES, ids=NAMES)
def test_clean_logs_never_exceed_their_uncertainty(
    way: tuple[tuple[float, float, float], ...], places_of: Places
) -> None:
    random = np.random.default_rng(11)
    for _ in range(20):
        places = places_of(log_of(way, random, np.zeros(3)))
        assert not places.is_beyond.any()


@pytest.mark.parametrize(("way", "places_of"), CASES, ids=NAMES)
def test_random_offsets_lie_within_the_uncertainty(
    way: tuple[tuple[float, float, float], ...], places_of: Places
) -> None:
    random = np.random.default_rng(12)
    is_turned = way is test_revolved.WAY
    for _ in range(20):
        turn, size = random.uniform(0.0, 2.0 * np.pi), random.uniform(0.005, 0.4)
        across = size * np.array([np.cos(turn), np.sin(turn)])
        offset = np.array([across[0], 0.0, across[1]] if is_turned else [*across, 0.0])
        truth = places_of(samples_at(sampled(way, 0.004) + offset))
        found = places_of(log_of(way, random, offset))
        wrong = (
            np.abs(found.deviation - truth.deviation) - found.uncertainty - truth.uncertainty
        )
        assert wrong.max() <= CLOSE
        gouge = np.maximum(-truth.deviation, 0.0) + truth.uncertainty
        assert (found.certain - gouge).max() <= CLOSE


def test_a_lost_corner_is_no_excess_though_material_was_left_before() -> None:
    samples = samples_at(sampled(POCKET, 0.04))
    beside = np.hypot(*(samples.position[:, :2] - [28.7, 19.7]).T)
    corner = samples.time[np.flatnonzero(beside < 0.05)[-1]]
    kept = np.abs(samples.time - corner) > 0.5
    lost = LoggedSamples(
        time=samples.time[kept], position=samples.position[kept], tool=samples.tool[kept],
        workingstep=samples.workingstep[kept],
    )  # fmt: skip
    places = milled(lost)
    assert places.deviation.max() > 0.3
    assert not places.is_beyond.any()
    # Material that is left elsewhere is one.
    rows = np.flatnonzero(samples.time > samples.time[-1] - 20.0)
    assert milled(samples[: int(rows[0])]).is_beyond.any()
