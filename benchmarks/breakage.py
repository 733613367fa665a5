"""Healthy cutters with runout, and lost teeth, on the bracket under control.

Every run has an eccentricity of 0 to 30 µm. Healthy runs are stretches of each roughing
workingstep in turn; none may be stopped. Teeth are lost in stretches at whose beginning nothing
is known of the cutter: at any time with chips, up to 150 revolutions after that, learning and
corners included; in the first six revolutions only; within three revolutions of a change of the
arc of contact by more than 0.1 rad only. Draws go on until as many teeth were cutting as asked
for. A tooth that takes less than a tenth of the feed per tooth in any of the three revolutions
after its loss, by runout or because the cut ends, is undecidable, and so is one in a revolution
with less force than the loop takes for chips. All is seeded.
``python -m benchmarks.breakage``
"""

import argparse
import itertools
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import cache, partial
from math import inf
from pathlib import Path
from typing import Any

import numpy as np

from service.control.run import prepare
from service.control.setup import steps_of
from service.requests.runs import ControlRequest
from service.simulation.run import RunFiles
from simulator.motion.segments import Bools, Floats, Ints
from tests.closed_loop.teeth import AFTER, WITHIN, Found, Healthy, Job, Loss, healthy, lost

BRACKET = Path(__file__).parents[1] / "examples" / "parts" / "bracket.stpnc"

ROUGHING = (
    "ROUGH FACE",
    "ROUGH CONTOUR",
    "MILL STEP",
    "MILL SLOT",
    "ROUGH POCKET",
    "ROUGH OPEN POCKET",
)

MOST_ECCENTRIC = 0.03
"""mm"""

STRETCH = 30.0
"""s of a healthy run, from a place that is drawn"""

LEARNING, MOST_LEAD = 6.0, 150.0
"""revolutions before a loss with which a stretch begins at most, while learning and else"""

NEAR = 3
"""revolutions about a change of the arc of contact"""

TURN = 0.1
"""rad, such a change"""

BATCH = 50
"""losses drawn at once"""

Mapped = Callable[[Callable[[int], Any], Iterable[int]], Iterable[Any]]
"""``map``, or that of a pool"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Kind:
    """Kind of place at which losses are drawn."""

    name: str
    is_corner: bool = False
    """only near a change of the arc of contact"""
    most_lead: float = MOST_LEAD
    """revolutions"""


KINDS = (
    Kind(name="at any time"),
    Kind(name="while learning", most_lead=LEARNING),
    Kind(name="in corners", is_corner=True),
)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Bracket:
    """The part under control, planned."""

    job: Job
    rough: Mapping[str, Ints]
    """cells of each roughing workingstep"""

    def weights(self, kind: Kind) -> Floats:
        """(N,) probability of a loss in each cell: by its time with chips."""
        course = self.job.course
        cuts = np.zeros(len(course), bool)
        for rows in self.rough.values():
            cuts[rows] = course.can_override[rows] & (course.force[rows] > 0.0)
        if kind.is_corner:
            turn = np.abs(np.diff(course.exit_angle - course.entry_angle, prepend=0.0)) > TURN
            cuts &= self._near(turn)
        seconds = np.diff(course.until, prepend=0.0) * cuts
        weights: Floats = seconds / seconds.sum()
        return weights

    def _near(self, changed: Bools) -> Bools:
        """Cells within some revolutions of those that are marked."""
        course = self.job.course
        at = course.until[np.flatnonzero(changed)]
        after = np.searchsorted(at, course.until)
        apart = np.full(len(course), inf)
        for neighbour in (after - 1, after):
            place = at[np.clip(neighbour, 0, len(at) - 1)]
            apart = np.minimum(apart, np.abs(course.until - place))
        near: Bools = apart * course.spindle_speed <= NEAR
        return near


def main(arguments: list[str] | None = None) -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=200, help="healthy ones, and losses each")
    parser.add_argument(
        "--whole", action="store_true", help="healthy runs of whole workingsteps"
    )
    options = parser.parse_args(arguments)
    bracket()  # compiled before the workers start
    with ProcessPoolExecutor() as pool:
        _print_healthy(pool.map, options.runs, is_whole=options.whole)
        _print_losses(pool.map, options.runs)


@cache
def bracket() -> Bracket:
    """The bracket; once in each process."""
    session = prepare(ControlRequest(has_preview=False), RunFiles(file=BRACKET))
    steps = steps_of(session.planned, session.advices)
    course = session.machine.course
    rough = {
        name: np.flatnonzero(course.workingstep == session.workingsteps.index(name) + 1)
        for name in ROUGHING
    }
    return Bracket(
        job=Job(course=course, steps=steps, settings=session.loop.state.settings), rough=rough
    )


def healthy_run(seed: int, *, is_whole: bool) -> Healthy:
    """A healthy run: one of the roughing workingsteps in turn."""
    random = np.random.default_rng(seed)
    part = bracket()
    rows, until = part.rough[ROUGHING[seed % len(ROUGHING)]], part.job.course.until
    first, beyond = int(rows[0]), int(rows[-1]) + 1
    if not is_whole:
        latest = max(until[beyond - 1] - STRETCH, until[first])
        first = int(random.choice(rows[until[rows] <= latest]))
        beyond = min(beyond, int(until.searchsorted(until[first] + STRETCH)) + 1)
    job = part.job.stretch(first, beyond)
    return healthy(job, eccentricity=random.uniform(0.0, MOST_ECCENTRIC), seed=seed)


def lost_tooth(seed: int, kind: Kind) -> Found:
    """A loss of a kind."""
    random = np.random.default_rng((KINDS.index(kind), seed))
    part = bracket()
    course, until = part.job.course, part.job.course.until
    cell = int(random.choice(len(course), p=part.weights(kind)))
    speed = float(course.spindle_speed[cell])
    rows = next(rows for rows in part.rough.values() if rows[0] <= cell <= rows[-1])
    lead = random.uniform(0.0, kind.most_lead) / speed
    first = max(int(rows[0]), int(until.searchsorted(until[cell] - lead)))
    beyond = int(until.searchsorted(until[cell] + 2.0 * AFTER / speed)) + 1
    before = float(until[first - 1]) if first else 0.0
    width = float(until[cell] - until[cell - 1]) if cell else float(until[cell])
    return lost(
        Loss(
            job=part.job.stretch(first, min(beyond, int(rows[-1]) + 1)),
            time=float(until[cell]) - before - width * random.random(),
            tooth=int(random.integers(course.teeth[cell])),
            eccentricity=random.uniform(0.0, MOST_ECCENTRIC),
            seed=seed,
        )
    )


def losses(count: int, kind: Kind, mapped: Mapped = map) -> list[Found]:
    """Losses until so many teeth were cutting."""
    found: list[Found] = []
    for seed in itertools.count(0, BATCH):
        found += mapped(partial(lost_tooth, kind=kind), range(seed, seed + BATCH))
        cutting = np.cumsum([each.is_decidable for each in found])
        if cutting[-1] >= count:
            return found[: int(cutting.searchsorted(count)) + 1]
    raise AssertionError


def _print_healthy(mapped: Mapped, runs: int, *, is_whole: bool) -> None:
    found = list(mapped(partial(healthy_run, is_whole=is_whole), range(runs)))
    print("| healthy cutter | runs | revolutions with chips | stopped |")
    print("|---|---|---|---|")
    for row, name in enumerate((*ROUGHING, "all")):
        some = found if name == "all" else found[row :: len(ROUGHING)]
        revolutions = sum(each.revolutions for each in some)
        stopped = [each.stopped_by for each in some if each.stopped_by]
        why = f": {'; '.join(sorted(set(stopped)))}" if stopped else ""
        print(f"| {name} | {len(some)} | {revolutions} | {len(stopped)}{why} |")


def _print_losses(mapped: Mapped, count: int) -> None:
    print(
        f"\n| tooth lost | cutting | found within {WITHIN:g} revolutions | later | missed "
        "| stopped before | undecidable beside them |"
    )
    print("|---|---|---|---|---|---|---|")
    for kind in KINDS:
        found = losses(count, kind, mapped)
        cutting = [each for each in found if each.is_decidable]
        early = sum(each.was_stopped for each in found)
        timely = sum(each.is_in_time for each in cutting)
        missed = sum(each.revolutions == inf for each in cutting)
        rest, share = len(found) - len(cutting) - early, 100.0 * timely / len(cutting)
        print(
            f"| {kind.name} | {len(cutting)} | {timely} ({share:.1f} %) "
            f"| {len(cutting) - timely - missed} | {missed} | {early} "
            f"| {rest} of {len(found)} ({100.0 * rest / len(found):.0f} %) |"
        )


if __name__ == "__main__":
    main()
