"""A run of the virtual machine, published by an agent in real or scaled time."""

import asyncio
import socket
import time
from collections.abc import Sequence
from dataclasses import dataclass, field

import uvicorn

from service.reading import Tell, silent
from service.requests.agent import AgentRequest
from service.requests.fields import require_bounds
from service.simulation.run import RunFiles, simulate
from simulator.agent.agent import Agent
from simulator.agent.http import application
from simulator.agent.machine_feed import RunFeed, beginning, run_feed
from simulator.agent.machine_model import MachineModel, machine_model
from simulator.machine.samples import Samples, joined
from simulator.spec import Machine
from stepnc_model.errors import StepNcError

STEP = 0.02
"""s of wall-clock time between looks at what is due"""

MICRO = 1_000_000


@dataclass(kw_only=True)
class SampleCollector:
    """Gathers the samples of a run. Running state."""

    parts: list[Samples] = field(default_factory=list)
    workingsteps: Sequence[str] = ()

    def begin(self, workingsteps: Sequence[str]) -> None:
        """See :class:`service.simulation.gathering.SampleWatcher`."""
        self.workingsteps = workingsteps

    def add(self, samples: Samples) -> None:
        """See :class:`service.simulation.gathering.SampleWatcher`."""
        self.parts.append(samples)


@dataclass(frozen=True, slots=True, kw_only=True)
class PublishedRun:
    """A run with the device model that shows it."""

    program: str
    machine: Machine
    model: MachineModel
    feed: RunFeed


def published_run(
    request: AgentRequest, files: RunFiles, *, tell: Tell = silent
) -> PublishedRun:
    """Simulate a program and turn its samples into observations.

    Raises
    ------
    StepNcError
        For everything that is wrong with file, names or numbers.
    """
    require_bounds(request)
    if request.is_looped and (request.speed > 1.0 or request.speed == 0.0):
        raise StepNcError(
            "--loop: only at a speed of at most 1, as stamps never pass the clock"
        )
    collector = SampleCollector()
    simulation = simulate(request, files, tell=tell, watchers=[collector])
    model = machine_model(simulation.machine, version=request.schema, names=request.names)
    feed = run_feed(
        joined(collector.parts),
        simulation.machine,
        model,
        workingsteps=collector.workingsteps,
    )
    return PublishedRun(
        program=simulation.program, machine=simulation.machine, model=model, feed=feed
    )


def serve_agent(request: AgentRequest, files: RunFiles, *, tell: Tell = silent) -> None:
    """Simulate a program, and serve the run until told to stop.

    Raises
    ------
    StepNcError
        As :func:`published_run`, and when the port is not free.
    """
    with _listening(request) as listener:
        run = published_run(request, files, tell=tell)
        if run.model.left_out:
            names = ", ".join(run.model.left_out)
            tell(f"left out, as schema {request.schema} does not know them: {names}")
        host, port = listener.getsockname()[:2]
        shown = f"[{host}]" if ":" in host else host
        tell(f"MTConnect agent of '{run.machine.name}': http://{shown}:{port}/current")
        asyncio.run(_serve(request, run, listener))


def new_agent(request: AgentRequest, run: PublishedRun) -> Agent:
    """An agent that has no observation of the run yet."""
    return Agent(model=run.model.model, clock=now, size=request.buffer)


async def play(agent: Agent, run: PublishedRun, *, speed: float, is_looped: bool) -> None:
    """Hand observations to an agent when they are due.

    Stamps are simulated time. It is anchored so that the last one is not after the clock.
    """
    feed, count = run.feed, 0
    while True:
        begin = now()
        duration = int(feed.duration * MICRO)
        ahead = duration - int(duration / speed) if speed > 1.0 else 0
        anchor = begin - (duration if speed == 0.0 else ahead)
        first = beginning(run.model, program=run.program, part_count=count)
        agent.tell(first, time=anchor)
        at, total = 0, len(feed.values)
        while at < total:
            due = feed.duration if speed == 0.0 else speed * (now() - begin) / MICRO
            end = int(feed.times.searchsorted(due, side="right"))
            stamps = anchor + (feed.times[at:end] * MICRO).astype(int)
            agent.add(feed.items[at:end], stamps, feed.values[at:end])
            at = end
            await asyncio.sleep(STEP if at < total else 0.0)
        count += 1
        parts = [id for id in first if first[id] == count - 1 and id.endswith("parts")]
        agent.tell(dict.fromkeys(parts, count))
        if not is_looped:
            return


def now() -> int:
    """Wall-clock time, µs since 1970."""
    return time.time_ns() // 1000


async def _serve(request: AgentRequest, run: PublishedRun, listener: socket.socket) -> None:
    agent = new_agent(request, run)
    config = uvicorn.Config(
        application(agent),
        log_config=None,
        access_log=False,
        server_header=False,
        ws="none",
        lifespan="off",
        timeout_keep_alive=30,
        timeout_graceful_shutdown=2,
    )
    player = asyncio.create_task(
        play(agent, run, speed=request.speed, is_looped=request.is_looped)
    )
    try:
        await uvicorn.Server(config).serve(sockets=[listener])
    finally:
        player.cancel()


def _listening(request: AgentRequest) -> socket.socket:
    """A socket that listens, before anything is simulated."""
    family = socket.AF_INET6 if ":" in request.host else socket.AF_INET
    try:
        return socket.create_server((request.host, request.port), family=family)
    except OSError as error:
        where = f"{request.host}, port {request.port}"
        raise StepNcError(f"{where}: {error.strerror or error}; --port names another") from None
