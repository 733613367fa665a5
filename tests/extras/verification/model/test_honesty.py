"""Uncertainties are honest: what random logs show lies within them, place by place.

The truth of a log is what a dense one of the same path shows.
"""

from collections.abc import Callable
from math import cos, sin

import numpy as np
import pytest

from extras.verification.model.deviation import SurfacePlaces, surface_places
from extras.verification.model.logged_bar import LoggedBar
from extras.verification.model.logged_part import LoggedPart, LoggedSamples
from extras.verification.model.path import ProgrammedRun, programmed_path
from extras.verification.model.required_bar import required_turned_places
from extras.verification.model.required_part import required_places
from extras.verification.model.surface import programmed_part
from extras.verification.model.turned_part import turned_part, turned_places
from simulator.motion.control import ExactStop
from simulator.motion.segments import AxisLimits, Floats, Motion, Segments, chained, lines
from simulator.removal.cutter import Insert
from simulator.removal.mesh_stock import required_bar
from tests.extras.verification.model import test_required_bar as test_revolved
from tests.extras.verification.model import test_required_part as test_required
from tests.extras.verification.model.block import sampled, samples_at
from tests.extras.verification.model.meshes import revolved

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


BLADE = Insert(width=0.8)
GROOVES = 12
"""random grooves"""

LIMITS = AxisLimits(
    rapid=np.full(3, 200.0), feed=np.full(3, 100.0), acceleration=np.full(3, 3e3)
)


def grooves(random: np.random.Generator) -> Segments:
    """Two plunges beside each other, in and out at feeds of their own, with rapids between."""
    bottom = float(random.uniform(14.0, 18.0))
    parts = [lines([(24.0, 0.0, 2.0), (24.0, 0.0, -20.0)])]
    for z, after in ((-20.0, -21.0), (-21.0, 2.0)):
        top, bottom = 20.5, bottom + float(random.choice([0.0, 0.3]))
        into, out = random.uniform(5.0, 25.0, 2) if random.integers(2) else [12.0, 12.0]
        parts += [
            lines([(24.0, 0.0, z), (top, 0.0, z)]),
            lines([(top, 0.0, z), (bottom, 0.0, z)], speed=float(into)),
            lines([(bottom, 0.0, z), (top, 0.0, z)], speed=float(out)),
            lines([(top, 0.0, z), (24.0, 0.0, z), (24.0, 0.0, after)]),
        ]
    return chained(parts)


def groove_log(motion: Motion, random: np.random.Generator, offset: Floats) -> LoggedSamples:
    """Positions at a random rate, phase and jitter; jitter also of their stamps alone."""
    interval = float(random.choice([0.03, 0.1]))
    times = np.arange(float(random.uniform(0.0, interval)), motion.duration, interval)
    off = (
        interval
        * random.uniform(-0.4, 0.4, (2, len(times)))
        * np.array([[0.0], [float(random.integers(0, 2))]])
    )
    position = motion.at(np.clip(times + off[0], 0.0, motion.duration)).position + offset
    count = len(times)
    return LoggedSamples(
        time=times + off[0] + off[1] * (off[0] == 0.0), position=np.round(position, 4),
        tool=np.ones(count, dtype=np.int64), workingstep=np.zeros(count, dtype=np.int64),
    )  # fmt: skip


@pytest.mark.parametrize("seed", range(GROOVES))
def test_bottoms_of_grooves_are_never_more_certain_than_the_log(seed: int) -> None:
    random = np.random.default_rng([13, seed])
    segments = grooves(random)
    run = ProgrammedRun(cutter=BLADE, tool=1, workingstep=0, segments=segments)
    part = turned_part(programmed_path([run]), test_revolved.BAR)
    motion = ExactStop().plan(segments, LIMITS)

    def places_of(samples: LoggedSamples) -> SurfacePlaces:
        left = LoggedBar(part.bar, test_revolved.BAR, {1: BLADE})
        left.add(samples)
        return turned_places(part, left)

    assert not places_of(groove_log(motion, random, np.zeros(3))).is_beyond.any()
    offset = np.array([random.uniform(-0.4, 0.4), 0.0, random.uniform(-0.1, 0.1)])
    dense = motion.at(np.arange(0.0, motion.duration, 2e-4)).position + offset
    truth = places_of(samples_at(dense, interval=2e-4))
    found = places_of(groove_log(motion, random, offset))
    wrong = np.abs(found.deviation - truth.deviation) - found.uncertainty - truth.uncertainty
    is_bottom = ~found.is_wall & (found.position[:, 0] < 19.0)
    assert wrong[is_bottom].max() <= CLOSE
