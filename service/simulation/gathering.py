"""Collector of a run's totals, samples and plot signals on the virtual machine."""

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
"""Longest machining time, in s, about 100 days; more suggests a wrong feed or dwell."""


class SampleWatcher(Protocol):
    """Observer of the samples while the machine runs, e.g. a live view."""

    def begin(self, workingsteps: Sequence[str]) -> None:
        """Receive the list of workingstep ids, numbered from 1, which grows during the run."""

    def add(self, samples: Samples) -> None:
        """Receive samples, later than all before."""


class RunCollector:
    """Collected totals, samples and plot signals of a run."""

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
        """Number of the current block, plus the completed share of it."""
        self.share = 0.0
        """Completed share of the program that was reported last."""
        self._watchers = watchers
        for watcher in watchers:
            watcher.begin(virtual.workingsteps)
        self._machine = virtual.machine
        self._sampler = Sampler(virtual.machine, rate=rate)
        self._disturbed = Disturbed(
            disturbance=disturbance, rate=rate, efficiency=virtual.machine.spindle.efficiency
        )

    def add(self, episode: Episode, *, ticked: Callable[[], None]) -> None:
        """Add an episode of the run to totals and samples."""
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
    """Fractional block number at a time in s; blocks of a stretch count as equally long."""
    if episode.course is None:
        return float(episode.state.line)
    blocks = episode.course.segments.block
    share = (time - episode.begin) / (episode.end - episode.begin)
    return float(blocks[0] + share * (blocks[-1] - blocks[0]))


def require_sense(episode: Episode) -> None:
    """Refuse a program that takes no time or does not end."""
    if episode.state.execution is Execution.PROGRAM_COMPLETED and episode.end == 0.0:
        raise SimulationError("the program contains nothing that takes time")
    if episode.end > MOST_SECONDS:
        course = episode.course
        line = episode.state.line if course is None else int(course.segments.block[-1])
        text = f"{episode.end:.3g} s of machining: the limit is {MOST_SECONDS:g} s"
        raise ProgramFault(text, line)
