"""Collector of a run on the virtual machine: totals, samples, a trace."""

from collections.abc import Callable, Sequence
from typing import Protocol

from service.simulation.timeline_file import TimelineFile
from service.simulation.trace import TraceKeeper
from simulator.errors import ProgramFault, SimulationError
from simulator.machine.disturbance import Disturbance, Disturbed
from simulator.machine.samples import Episode, Execution, Samples
from simulator.machine.sensing import Sampler
from simulator.machine.totals import Total, added
from simulator.machine.virtual import VirtualMachine

MOST_SECONDS = 1e7
"""of machining, a hundred days: a slip of the feed or of a dwell rather than a program"""


class SampleWatcher(Protocol):
    """Observer of the samples while the machine runs: a live view."""

    def begin(self, workingsteps: Sequence[str]) -> None:
        """Told once: ids of the workingsteps by their number, from 1; they grow on the way."""

    def add(self, samples: Samples) -> None:
        """More samples, later than those before."""


class RunCollector:
    """Collected totals, samples and trace."""

    def __init__(
        self,
        virtual: VirtualMachine,
        disturbance: Disturbance,
        *,
        rate: float,
        watchers: Sequence[SampleWatcher],
    ) -> None:
        self.totals = [Total()]
        self.file: TimelineFile | None = None
        self.trace: TraceKeeper | None = None
        self.block = 0.0
        """number of the block that runs, with the share of it that is behind"""
        self.share = 0.0
        """of the program that is behind, as it was told last"""
        self._watchers = watchers
        for watcher in watchers:
            watcher.begin(virtual.workingsteps)
        self._machine = virtual.machine
        self._sampler = Sampler(virtual.machine, rate=rate)
        self._disturbed = Disturbed(
            disturbance=disturbance, rate=rate, efficiency=virtual.machine.spindle.efficiency
        )

    def add(self, episode: Episode, *, ticked: Callable[[], None]) -> None:
        """One more episode."""
        require_sense(episode)
        at = episode.state.workingstep
        self.totals += [Total() for _ in range(len(self.totals), at + 1)]
        self.totals[at] = added(self.totals[at], episode, self._machine)
        self.block = block_at(episode, episode.begin)
        ticked()
        takers = [
            taker for taker in (self.file, self.trace, *self._watchers) if taker is not None
        ]
        if not takers:
            return
        for samples in self._sampler.samples(episode):
            shown = self._disturbed.shown(samples)
            for taker in takers:
                taker.add(shown)
            self.block = block_at(episode, float(samples.time[-1]))
            ticked()


def block_at(episode: Episode, time: float) -> float:
    """Number of the block that runs at a time, s; those of a stretch count as equally long."""
    if episode.course is None:
        return float(episode.state.line)
    blocks = episode.course.segments.block
    share = (time - episode.begin) / (episode.end - episode.begin)
    return float(blocks[0] + share * (blocks[-1] - blocks[0]))


def require_sense(episode: Episode) -> None:
    """Refuse a program without anything in it, and one without an end."""
    if episode.state.execution is Execution.PROGRAM_COMPLETED and episode.end == 0.0:
        raise SimulationError("there is nothing in it that takes time")
    if episode.end > MOST_SECONDS:
        course = episode.course
        line = episode.state.line if course is None else int(course.segments.block[-1])
        text = f"{episode.end:.3g} s of machining: {MOST_SECONDS:g} s at most"
        raise ProgramFault(text, line)
