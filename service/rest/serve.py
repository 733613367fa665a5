"""Start of the service: the web processes and the process that runs jobs."""

import multiprocessing
import os
import shutil
import socket
import threading
from dataclasses import dataclass, replace
from multiprocessing.context import SpawnProcess
from pathlib import Path

import structlog
from uvicorn.config import STARTUP_FAILURE
from uvicorn.supervisors import Multiprocess

from service.errors import Forbidden
from service.jobs import runner
from service.monitor.source import MonitorSource
from service.optional_packages import has_package, how_to_install
from service.processes import log_lines
from service.processes.lifeline import starting
from service.rest.metrics import SHARED
from service.rest.settings import Settings
from service.rest.web_config import WebConfig
from service.storage import keys, library
from service.storage.folder import (
    OTHERS,
    DataFolder,
    FolderAddress,
    open_data_folder,
    require_shared_files,
)
from service.web.http_protocol import BoundedHttpProtocol, WebServer
from stepnc_model.errors import StepNcError

LOG = structlog.get_logger("serve")

AGAIN = 1.0
"""Delay before a runner that has ended is started again, in s."""

KEEP_ALIVE = 20
"""Time for which an idle connection is kept open, in s."""

FAREWELL = 5
"""Time for open requests to finish when the service stops, in s."""

MOST_CONNECTIONS = 2000


@dataclass(frozen=True, slots=True, kw_only=True)
class ServerOptions:
    """Options of the server."""

    settings: Settings
    workers: int
    """Number of web processes."""
    jobs: int
    """Number of jobs that run at once."""
    job_memory: int = runner.MOST_MEMORY
    """Greatest address space of a job, bytes."""
    certificate: Path | None = None
    key: Path | None = None


def serve(start: ServerOptions) -> None:
    """Run the service until it is told to stop.

    Raises
    ------
    StepNcError
        When the service cannot be started.
    """
    settings = start.settings
    # What this process and its children make is for its user alone.
    os.umask(OTHERS)
    data_folder = open_data_folder(
        settings.root,
        knowledge=settings.knowledge,
        database=settings.database,
        files=settings.files,
    )
    require_shared_files(data_folder)
    if settings.needs_keys and not any(
        each.revoked is None for each in keys.listed(data_folder)
    ):
        command = f"stepnc keys create --for NAME --role planner --data {settings.data}"
        raise Forbidden(f"host {settings.host} requires keys, but none exists: {command}")
    for file in (start.certificate, start.key):
        if file is not None and not file.is_file():
            raise StepNcError(f"{file}: no such file")
    for source in settings.agents:
        _require_machine(data_folder, source)
    _require_port(settings)
    with runner.locked(data_folder.root, "server"):
        with runner.locked(data_folder.root):
            """Fail at once if the runner of an earlier server is still alive."""
        _serve(start, data_folder)


def _serve(start: ServerOptions, data_folder: DataFolder) -> None:
    settings = replace(start.settings, has_agent=start.workers == 1)
    settings.hand_on()
    log_lines.configure(settings.level)
    log_lines.report_faults()
    if start.workers > 1:
        _share_metrics(data_folder.root)
    keeper = RunnerKeeper(start, data_folder.address)
    if not has_package("pyarrow"):
        LOG.warning(
            "no samples of runs are kept", reason=f"Parquet: {how_to_install('pyarrow')}"
        )
    LOG.info("serving", host=settings.host, port=settings.port, data=str(data_folder.root))
    try:
        keeper.start()
        _run_web(_web_config(start))
    finally:
        keeper.stop()


def _web_config(start: ServerOptions) -> WebConfig:
    return WebConfig(
        "service.rest.app:from_environment",
        factory=True,
        http=BoundedHttpProtocol,
        ws="none",
        host=start.settings.host,
        port=start.settings.port,
        workers=start.workers,
        log_config=None,
        access_log=False,
        server_header=False,
        proxy_headers=False,
        timeout_keep_alive=KEEP_ALIVE,
        timeout_graceful_shutdown=FAREWELL,
        limit_concurrency=MOST_CONNECTIONS,
        ssl_certfile=None if start.certificate is None else str(start.certificate),
        ssl_keyfile=None if start.key is None else str(start.key),
    )


def _run_web(config: WebConfig) -> None:
    """Serve in this process, or in several that this one watches."""
    if config.workers > 1:
        with config.bind_socket() as listening:
            WebProcesses(config, sockets=[listening]).run()
        return
    server = WebServer(config)
    try:
        # Before uvicorn takes the signals: it would answer them when all is loaded.
        config.load()
        server.run()
    except KeyboardInterrupt:
        return
    if not server.started:
        raise SystemExit(STARTUP_FAILURE)


def _require_machine(data_folder: DataFolder, source: MonitorSource) -> None:
    """Refuse an agent of a machine that neither the library nor the shop has."""
    try:
        library.require(data_folder, machine=source.name, material="")
    except StepNcError as error:
        raise StepNcError(f"--agent {source.name}={source.url}: {error}") from error


def _require_port(settings: Settings) -> None:
    """Refuse a port that is in use or not permitted."""
    family = socket.AF_INET6 if ":" in settings.host else socket.AF_INET
    try:
        socket.create_server((settings.host, settings.port), family=family).close()
    except OSError as error:
        where = f"{settings.host}, port {settings.port}"
        raise StepNcError(f"{where}: {error.strerror or error}; try another --port") from None


class WebProcesses(Multiprocess):
    """Processes that serve, of which this one answers Ctrl-C. Running state."""

    def init_processes(self) -> None:
        """Start the processes."""
        with starting():
            super().init_processes()

    def keep_subprocess_alive(self) -> None:
        """Replace processes that have ended."""
        with starting():
            super().keep_subprocess_alive()


class RunnerKeeper:
    """Keeps the runner process alive. Running state."""

    def __init__(self, start: ServerOptions, folder: FolderAddress) -> None:
        level = start.settings.level
        bounds = (start.jobs, start.job_memory)
        self._arguments = (level, run_jobs, folder, *bounds, os.getpid(), level)
        self._is_stopping = threading.Event()
        self._process: SpawnProcess | None = None
        self._thread = threading.Thread(target=self._keep, daemon=True)

    def start(self) -> None:
        """Start the first runner and the thread that watches it."""
        self._process = self._started()
        self._thread.start()

    def stop(self) -> None:
        """End the runner; the next runner restarts its unfinished jobs."""
        self._is_stopping.set()
        self._thread.join()
        if self._process is not None:
            self._process.terminate()
            self._process.join(FAREWELL)
            self._process.kill()
            self._process.join()

    def _started(self) -> SpawnProcess:
        context = multiprocessing.get_context("spawn")
        process = context.Process(target=log_lines.reported, args=self._arguments, daemon=False)
        with starting():
            process.start()
        return process

    def _keep(self) -> None:
        while not self._is_stopping.wait(AGAIN):
            if self._process is not None and not self._process.is_alive():
                LOG.error("the job runner has ended", exit_code=self._process.exitcode)
                self._process = self._started()


def run_jobs(folder: FolderAddress, workers: int, memory: int, parent: int, level: str) -> None:
    """Run jobs; main function of the runner process."""
    try:
        runner.main(folder, workers, parent, level=level, memory=memory)
    except StepNcError as error:
        # The message says what is wrong; no traceback is needed.
        LOG.error("jobs cannot be run", reason=str(error))  # noqa: TRY400


def _share_metrics(root: Path) -> None:
    """Let the processes share metrics through files in a folder emptied at each start."""
    folder = root / "metrics"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(mode=0o700)
    os.environ[SHARED] = str(folder)
