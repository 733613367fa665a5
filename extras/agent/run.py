"""A run of the virtual machine, published by an agent in real or scaled time."""

import asyncio
import socket
from collections.abc import Callable, Coroutine, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

import uvicorn

from extras.agent.model.adapters import AdapterAddress, AdapterIntake, ShdrServer, listen_to
from extras.agent.model.agent import Agent, StreamQuery
from extras.agent.model.buffer import Value
from extras.agent.model.http import application
from extras.agent.model.machine_feed import RunFeed, beginning, run_feed
from extras.agent.model.machine_model import MachineModel, device_uuid, machine_model
from extras.agent.model.model import DeviceModel, read_model
from extras.agent.model.schemas import SchemaFiles, read_schemas
from extras.agent.model.tool_assets import tool_asset
from extras.agent.play import PlayableRun, begun, now, play
from extras.agent.requests import AgentRequest
from extras.agent.run_routes import Application, with_runs
from service.files import LOGS, plain_name, require_place, write_atomically
from service.optional_packages import missing_extras_named
from service.progress import Tell, silent
from service.requests.fields import require_bounds
from service.requests.runs import SimulationRequest
from service.simulation.run import RunFiles, Simulation, simulate
from service.web.http_protocol import BoundedHttpProtocol, WebServer
from service.web.known_hosts import for_known_hosts, known_hosts
from simulator.client.document_choices import DocumentChoice, NameSet, SchemaVersion
from simulator.library import load_machine
from simulator.machine.samples import Samples, joined
from simulator.machine.virtual import LoadedTool
from simulator.spec import Machine
from stepnc_model.errors import StepNcError
from stepnc_model.plurals import counted
from stepnc_model.units import US_PER_SECOND

FAREWELL = 10
"""s that answers may still take at the end; streams end at once"""

BACKLOG = 2048
"""connections that may wait to be accepted"""

LEAST_BUFFER = 1000

Work = Callable[[], Coroutine[Any, Any, None]]
"""what goes on beside the server"""


@dataclass(kw_only=True)
class SampleCollector:
    """Gathers the samples of a run. Running state."""

    parts: list[Samples] = field(default_factory=list)
    workingsteps: Sequence[str] = ()

    def begin(self, workingsteps: Sequence[str]) -> None:
        """See :class:`service.simulation.run_collector.SampleWatcher`."""
        self.workingsteps = workingsteps

    def add(self, samples: Samples) -> None:
        """See :class:`service.simulation.run_collector.SampleWatcher`."""
        self.parts.append(samples)


@dataclass(frozen=True, slots=True, kw_only=True)
class PublishedRun:
    """A run with the device model that shows it."""

    program: str
    machine: Machine
    model: MachineModel
    feed: RunFeed
    tools: tuple[LoadedTool, ...]
    part: str = ""
    """Id of the part; empty: that of its batch with its number, if there is a batch."""
    batch: str = ""

    @property
    def devices(self) -> DeviceModel:
        """See :class:`extras.agent.play.PlayableRun`."""
        return self.model.model

    @property
    def duration(self) -> float:
        """See :class:`extras.agent.play.PlayableRun`."""
        return self.feed.duration

    def feeds(self) -> Iterator[RunFeed]:
        """See :class:`extras.agent.play.PlayableRun`."""
        yield self.feed

    def first(self, count: int) -> Mapping[str, Value]:
        """See :class:`extras.agent.play.PlayableRun`."""
        part = self.part or (f"{self.batch}-{count}" if self.batch else "")
        return beginning(
            self.model, program=self.program, part_count=count, part=part, batch=self.batch
        )

    def equip(self, agent: Agent) -> None:
        """Add the tools of the program."""
        name, uuid = self.machine.name, device_uuid(self.machine)
        index = agent.model.device_of(name) or 0
        for tool in self.tools:
            begin = agent.buffer.last_time
            agent.put(tool_asset(tool, device=name, uuid=uuid, index=index, time=begin))


def published_run(
    request: AgentRequest, files: RunFiles, *, tell: Tell = silent
) -> PublishedRun:
    """Simulate a program and turn its samples into observations.

    Raises
    ------
    StepNcError
        For everything that is wrong with file, names or numbers.
    """
    require_possible(request)
    require_bounds(request)
    collector = SampleCollector()
    simulation = simulate(request, files, tell=tell, watchers=[collector])
    run = shown_run(simulation, collector, version=request.schema, names=request.names)
    return replace(run, part=request.part, batch=request.batch)


def require_possible(request: AgentRequest) -> None:
    """Refuse to start again a run whose stamps would pass the clock."""
    if request.is_looped and (request.speed > 1.0 or request.speed == 0.0):
        raise StepNcError(
            "--loop: only at a speed of at most 1, as stamps never pass the clock"
        )


def shown_run(
    simulation: Simulation,
    collector: SampleCollector,
    *,
    version: SchemaVersion,
    names: NameSet,
) -> PublishedRun:
    """A simulated run as observations."""
    model = machine_model(simulation.machine, version=version, names=names)
    feed = run_feed(
        joined(collector.parts),
        simulation.machine,
        model,
        workingsteps=collector.workingsteps,
    )
    return PublishedRun(
        program=simulation.program,
        machine=simulation.machine,
        model=model,
        feed=feed,
        tools=tuple(simulation.tools[number] for number in sorted(simulation.tools)),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class AgentFiles:
    """Files of an agent: a program that is run, or a device model that adapters fill."""

    run: RunFiles
    device: Path | None = None
    schemas: Path | None = None
    """folder of schemas that are served"""
    runs: Path | None = None
    """Folder in which runs are kept and from which they are served."""


def serve_agent(request: AgentRequest, files: AgentFiles, *, tell: Tell = silent) -> None:
    """Serve a run of a program, or what adapters tell, until told to stop.

    Raises
    ------
    StepNcError
        As :func:`published_run`; for a device model, an address or schemas that cannot be
        used, and when a port is not free.
    """
    require_bounds(request)
    with ExitStack() as stack:
        listener = stack.enter_context(listening(request.host, request.port))
        schemas = SchemaFiles() if files.schemas is None else read_schemas(files.schemas)
        broker = _broker(request, tell)
        shdr = None
        if request.shdr_port is not None:
            shdr = stack.enter_context(listening(request.host, request.shdr_port))
            tell(f"SHDR adapter: {place_of(shdr)}")
        log = files.run.file
        if log is not None and log.suffix.lower() in LOGS:
            agent, work = replayed(request, files, log, tell=tell)
        elif files.device is not None:
            agent, work = adapted(request, files, tell=tell)
        else:
            agent, work = published(request, files.run, tell=tell)
        agent.allows_put, agent.writer.schemas = request.allows_put, schemas
        app = application(agent)
        if files.runs is not None:
            with missing_extras_named("--runs"):
                from extras.agent import runs  # noqa: PLC0415 (an extra)
            repository = runs.RunRepository(files.runs)
            stack.callback(runs.RunKeeper(agent, repository, tell=tell).close)
            app = with_runs(app, repository)
        tell(f"MTConnect agent: http://{place_of(listener)}/current")
        app = for_known_hosts(app, known_hosts(request.host, request.host_names))
        run_server(agent, app, [*work, *broker(agent)], listener, shdr=shdr)


def run_server(
    agent: Agent,
    app: Application,
    work: Sequence[Work],
    listener: socket.socket,
    *,
    shdr: socket.socket | None = None,
) -> None:
    """Serve an agent, and do what goes on beside it, until told to stop.

    Parameters
    ----------
    work : sequence
    listener : socket
    shdr : socket, optional
        Socket of an SHDR adapter that feeds other agents.
    """
    with asyncio.Runner(loop_factory=_new_loop) as runner:
        runner.run(_serve(agent, app, work, listener, shdr))


def _broker(request: AgentRequest, tell: Tell) -> Callable[[Agent], Sequence[Work]]:
    """Gives an agent the work that publishes it to an MQTT broker, if one is named."""
    if request.mqtt is None:
        return lambda _: ()
    address = _address(request.mqtt, "MQTT broker", "127.0.0.1:1883")
    with missing_extras_named("--mqtt"):
        from extras.agent.model.mqtt import MqttPublisher  # noqa: PLC0415 (an extra)
    host, port = address.host, address.port
    return lambda agent: [MqttPublisher(agent=agent, host=host, port=port, tell=tell).run]


def published(
    request: AgentRequest, files: RunFiles, *, tell: Tell
) -> tuple[Agent, Sequence[Work]]:
    """An agent, and the run that it publishes."""
    if request.adapters:
        raise StepNcError("--adapter: name the device model that it fills with --device")
    run = published_run(request, files, tell=tell)
    if run.model.left_out:
        names = ", ".join(run.model.left_out)
        tell(f"left out, as schema {request.schema} does not know them: {names}")
    return played(request, run)


def replayed(
    request: AgentRequest, files: AgentFiles, log: Path, *, tell: Tell
) -> tuple[Agent, Sequence[Work]]:
    """Return an agent, and the recorded run that it publishes again."""
    if request.adapters:
        raise StepNcError("--adapter: a recorded run and adapters exclude each other")
    require_possible(request)
    if files.device is not None:
        model = read_model(files.device)
    else:
        if not request.machine:
            raise StepNcError("name the machine with --machine, or its model with --device")
        machine = load_machine(request.machine)
        model = machine_model(machine, version=request.schema, names=request.names).model
    with missing_extras_named(log.name):
        from extras.agent.replay import read_log  # noqa: PLC0415 (an extra)
    return played(request, read_log(log, model, tell=tell))


def played(request: AgentRequest, run: PlayableRun) -> tuple[Agent, Sequence[Work]]:
    """Return an agent, and the work of playing a run."""
    agent = begun(run, speed=request.speed, size=request.buffer)
    speed, is_looped = request.speed, request.is_looped
    return agent, [lambda: play(agent, run, speed=speed, is_looped=is_looped)]


def adapted(
    request: AgentRequest, files: AgentFiles, *, tell: Tell
) -> tuple[Agent, Sequence[Work]]:
    """An agent of a device model, and its connections to adapters."""
    if files.run.file is not None or files.run.code is not None:
        raise StepNcError("--device serves what adapters tell: name no program beside it")
    if not request.adapters or files.device is None:
        raise StepNcError("--device: name its adapters with --adapter HOST:PORT")
    addresses = [_address(each, "adapter", "192.168.0.7:7878") for each in request.adapters]
    model = read_model(files.device)
    tell(f"device model: {files.device}, schema {model.version}, {len(model.items)} data items")
    agent = Agent(model=model, clock=now, size=request.buffer)
    intake = AdapterIntake(agent=agent, tell=tell)
    return agent, [partial(listen_to, address, intake) for address in addresses]


def _document_name(request: SimulationRequest, files: RunFiles, shown: DocumentChoice) -> str:
    part = shown.part or files.name or getattr(files.file, "stem", "")
    return f"{plain_name(f'{Path(request.machine).stem}_{part}')}.xml"


def simulated_with_document(
    request: SimulationRequest,
    files: RunFiles,
    output: Path,
    shown: DocumentChoice,
    *,
    tell: Tell = silent,
) -> Simulation:
    """Simulate a program, and write its samples as a document of MTConnect.

    Parameters
    ----------
    output : Path
        File of the document, or a folder in which its name is that of machine and part [1]_.

    Raises
    ------
    StepNcError
        As :func:`service.simulation.run.simulate`, and when the file cannot be written.

    References
    ----------
    .. [1] D. Lechevalier et al., "Simulating a virtual machining model in an agent-based model
       for advanced analytics", J. Intell. Manuf. (2018), 4.2.
    """
    if output.is_dir():
        output = output / _document_name(request, files, shown)
    for other in (files.file, files.output, files.report):
        if other is not None:
            require_place(output, apart_from=other)
    collector = SampleCollector()
    simulation = simulate(request, files, tell=tell, watchers=[collector])
    run = shown_run(simulation, collector, version=shown.version, names=shown.names)
    run = replace(run, part=shown.part, batch=shown.batch)
    write_atomically(output, streams_document(run))
    tell(f"MTConnect document: {output} ({counted(len(run.feed.values), 'observation')})")
    return simulation


def streams_document(run: PublishedRun) -> bytes:
    """The whole run as one document of streams, that ends now."""
    count = len(run.feed.values) + 2 * len(run.model.model.items)
    agent = begun(run, speed=0.0, size=max(LEAST_BUFFER, count))
    begin = agent.buffer.last_time
    agent.tell(run.first(0), time=begin)
    stamps = begin + (run.feed.times * US_PER_SECOND).astype(int)
    agent.add(run.feed.items, stamps, run.feed.values)
    return agent.sample(StreamQuery(chosen=None, count=agent.buffer.size))[0]


def _new_loop() -> asyncio.AbstractEventLoop:
    """The faster event loop where there is one."""
    try:
        import uvloop  # noqa: PLC0415 (not on Windows)
    except ImportError:
        return asyncio.new_event_loop()
    return uvloop.new_event_loop()


async def _serve(
    agent: Agent,
    app: Application,
    work: Sequence[Work],
    listener: socket.socket,
    shdr: socket.socket | None,
) -> None:
    config = uvicorn.Config(
        app,
        http=BoundedHttpProtocol,
        log_config=None,
        access_log=False,
        server_header=False,
        ws="none",
        lifespan="off",
        timeout_keep_alive=30,
        timeout_graceful_shutdown=FAREWELL,
    )
    if shdr is not None:
        await ShdrServer(agent).serve(shdr)
    tasks = [asyncio.create_task(each()) for each in work]
    try:
        await WebServer(config).serve(sockets=[listener])
    finally:
        for task in tasks:
            task.cancel()


def listening(host: str, port: int) -> socket.socket:
    """A socket that listens.

    Raises
    ------
    StepNcError
        When the port is not free, or there is no such address.
    """
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    # Only with its protocol named does asyncio send small answers at once.
    listener = socket.socket(family, socket.SOCK_STREAM, socket.IPPROTO_TCP)
    try:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind((host, port))
        listener.listen(BACKLOG)
    except OSError as error:
        listener.close()
        where = f"{host}, port {port}"
        raise StepNcError(f"{where}: {error.strerror or error}; name another") from None
    return listener


def place_of(listener: socket.socket) -> str:
    """Return host and port of a socket, as in an address."""
    host, port = listener.getsockname()[:2]
    return f"[{host}]:{port}" if ":" in host else f"{host}:{port}"


def _address(text: str, what: str, example: str) -> AdapterAddress:
    host, colon, port = text.rpartition(":")
    if not (colon and host and port.isdecimal() and 0 < int(port) < 1 << 16):
        raise StepNcError(f"{what} '{text}': expected HOST:PORT, as {example}")
    return AdapterAddress(host=host.strip("[]"), port=int(port))
