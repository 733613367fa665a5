"""Healthy cutters with runout, and lost teeth, in stretches of a program under control.

A stretch begins as if the program had been stopped there: nothing is known of the cutter. The
truth is the virtual machine's; how much of the feed a tooth takes is worked out here.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from math import inf, pi

import numpy as np

from controller.laws.choice import LawName, law_named
from controller.loop import Loop
from controller.orders import EventKind
from controller.signals.source import Dynamometer
from controller.states.loop_settings import LoopSettings, LoopStep
from service.control.setup import preview_of
from simulator.plant.controlled_machine import ControlledMachine, Instrumentation
from simulator.plant.course import NominalCourse
from simulator.plant.hidden_behaviour import HiddenChange, HiddenQuantity, HiddenTruth

WITHIN = 3.0
"""revolutions in which a lost tooth is to be found"""

CUTTING = 0.1
"""of the feed per tooth, mean over the arc, that a tooth must take in each of these revolutions
so that it counts as cutting"""

AFTER = 10.0
"""revolutions for which a trial goes on after a loss"""

_ARC = (np.arange(200) + 0.5) / 200.0
_EXACT = 1e-6  # revolutions: the loss falls between two tooth periods


@dataclass(frozen=True, slots=True, kw_only=True)
class Job:
    """A program under control."""

    course: NominalCourse
    steps: Sequence[LoopStep]
    settings: LoopSettings

    def stretch(self, first: int, beyond: int) -> "Job":
        """Some cells of the course."""
        begin = float(self.course.until[first - 1]) if first else 0.0
        columns = {
            each.name: getattr(self.course, each.name)[first:beyond]
            for each in fields(NominalCourse)
        }
        columns["until"] = columns["until"] - begin
        return replace(self, course=NominalCourse(**columns))

    def loop(self, hidden: HiddenTruth, *, seed: int) -> tuple[ControlledMachine, Loop]:
        """A machine and its loop at the beginning."""
        machine = ControlledMachine(self.course, hidden, Instrumentation(seed=seed))
        loop = Loop(
            machine,
            machine,
            source=Dynamometer(self.settings.chips),
            law=lambda plant: law_named(LawName.LOG_PI, plant, has_preview=False),
            steps=self.steps,
            preview=preview_of(self.course),
            settings=self.settings,
        )
        return machine, loop


@dataclass(frozen=True, slots=True, kw_only=True)
class Healthy:
    """A run with a whole cutter."""

    revolutions: int
    """with chips"""
    stopped_by: str
    """empty: it ran to its end"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Loss:
    """A tooth that breaks."""

    job: Job
    """the stretch in which it does"""
    time: float
    """s of the program"""
    tooth: int
    eccentricity: float
    """mm"""
    seed: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Found:
    """What became of a loss."""

    share: float
    """of the feed per tooth that the tooth would have taken, least in the revolutions in which
    it is to be found; 0: it was not in the work all the time, or hardly anything was"""
    revolutions: float
    """until it was found; infinite: it was not, or another tooth was named"""
    was_stopped: bool = False
    """before the loss, without need"""

    @property
    def is_decidable(self) -> bool:
        """Whether the tooth was cutting."""
        return self.share >= CUTTING

    @property
    def is_in_time(self) -> bool:
        """Whether it was found within the revolutions in which it is to be found."""
        return self.revolutions <= WITHIN + _EXACT


def healthy(job: Job, *, eccentricity: float, seed: int) -> Healthy:
    """Run a stretch with a whole cutter."""
    _, loop = job.loop(HiddenTruth(eccentricity=eccentricity), seed=seed)
    revolutions, why = 0, ""
    while not loop.state.is_stopped:
        cycle = loop.cycle()
        if cycle is None:
            break
        if cycle.revolution is not None and cycle.revolution.force > job.settings.chips:
            revolutions += 1
        why = next((each.text for each in cycle.events if each.kind is EventKind.STOP), why)
    return Healthy(revolutions=revolutions, stopped_by=why)


def lost(loss: Loss) -> Found:
    """Run a stretch in which a tooth breaks, and a little on."""
    course = loss.job.course
    hidden = HiddenTruth(eccentricity=loss.eccentricity)
    machine, loop = loss.job.loop(hidden, seed=loss.seed)
    while not loop.state.is_stopped and machine.share * course.duration < loss.time:
        if loop.cycle() is None:
            break
    if loop.state.is_stopped:
        return Found(share=0.0, revolutions=inf, was_stopped=True)
    machine.change(
        HiddenChange(time=machine.time, what=HiddenQuantity.TOOTH, value=float(loss.tooth))
    )
    begin, least, turned = machine.time, inf, 0.0
    while not loop.state.is_stopped and turned < AFTER:
        cycle = loop.cycle()
        if cycle is None:
            break
        reading = cycle.reading
        turned = (reading.time - begin) * reading.spindle_speed
        if turned <= WITHIN + _EXACT:
            cell = machine.truth.cell
            least = min(least, taken(course, cell, loss, override=reading.override))
            if (
                cycle.revolution is not None
                and cycle.revolution.force <= loss.job.settings.chips
            ):
                least = 0.0
        for event in cycle.events:
            name = f"tooth {loss.tooth + 1} of "
            if event.kind is EventKind.BREAKAGE and event.text.startswith(name):
                return Found(share=least, revolutions=turned)
    return Found(share=least if turned >= WITHIN else 0.0, revolutions=inf)


def taken(course: NominalCourse, cell: int, loss: Loss, *, override: float) -> float:
    """Mean chip of a tooth with runout over that without, by the surface that others left."""
    teeth, speed = int(course.teeth[cell]), float(course.spindle_speed[cell])
    per_tooth = override * float(course.feed[cell]) / (teeth * speed)
    entry, exit_ = float(course.entry_angle[cell]), float(course.exit_angle[cell])
    if not (exit_ > entry and per_tooth > 0.0):
        return 0.0
    sine = np.sin(entry + (exit_ - entry) * _ARC)
    height = loss.eccentricity * np.cos(2.0 * pi / teeth * np.arange(teeth)) / per_tooth
    chips = [
        before * sine + height[loss.tooth] - height[(loss.tooth - before) % teeth]
        for before in range(1, teeth + 1)
    ]
    return float(np.min(chips, axis=0).clip(min=0.0).sum() / sine.sum())
