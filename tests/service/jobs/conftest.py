"""A runner of jobs in a process of its own, on a data folder of its own."""

import os
import signal
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from subprocess import DEVNULL, Popen

import pytest

from kbe.store import open_store
from service.requests.advice import AdviceRequest
from service.requests.fields import dumped
from service.requests.runs import ControlRequest, SimulationRequest
from service.storage import jobs, programs
from service.storage.folder import DataFolder, open_data_folder
from service.storage.jobs import Job, JobKind, JobRequest, JobState
from tests.postgres import new_database, new_server, postgres_url
from tests.service.rest.samples import SAMPLE
from tests.service.shop import outcomes
from tests.service.waiting import ended, environment, until

__all__ = ["new_database", "new_server", "postgres_url"]

MAIN = """
import sys
from service.jobs.runner import main
from service.storage.folder import FolderAddress
main(FolderAddress(root=sys.argv[1], knowledge=sys.argv[2]), 1, int(sys.argv[3]))
"""

IMPATIENT = f"""
from service.storage import database
database.WAIT = 0.05
{MAIN}"""
"""waits for a locked database hardly at all"""


@dataclass(kw_only=True)
class Shop:
    """A data folder, and who runs its jobs. Running state."""

    data_folder: DataFolder
    program: str = ""
    runners: list[Popen[bytes]] = field(default_factory=list)

    @property
    def log(self) -> Path:
        """What runners say."""
        return self.data_folder.root.parent / "runner.log"

    def start(self, main: str = MAIN) -> Popen[bytes]:
        """A runner, once it looks at the queue."""
        with self.data_folder.database.writing() as connection:
            connection.execute("DELETE FROM runner")
        words = [str(self.data_folder.root), self.data_folder.knowledge, str(os.getpid())]
        with self.log.open("ab") as log:
            runner = Popen(
                [sys.executable, "-c", main, *words],
                env={**environment(self.data_folder.root.parent), "PYTHONUNBUFFERED": "1"},
                stdin=DEVNULL,
                stdout=log,
            )
        self.runners.append(runner)
        until(self._has_beaten, within=90.0)
        return runner

    def _has_beaten(self) -> bool:
        with self.data_folder.database.reading() as connection:
            return connection.execute("SELECT 1 FROM runner").fetchone() is not None

    def end(self) -> None:
        """All runners."""
        for runner in self.runners:
            runner.send_signal(signal.SIGTERM)
        for runner in self.runners:
            ended(runner)

    def order(self, kind: JobKind, program: str | None = None, **words: object) -> Job:
        """A job with the usual request, but for some words."""
        usual: dict[str, object] = {
            JobKind.ADVICE: dumped(AdviceRequest()),
            JobKind.SIMULATION: dumped(SimulationRequest()),
            JobKind.CONTROL: dumped(ControlRequest()),
            JobKind.TRIAL: {"inputs": {}, "seed": 0, "pace": 1.0},
        }[kind]
        named = "" if kind is JobKind.TRIAL else (program or self.program)
        request = {**usual, **words}
        return jobs.add(
            self.data_folder,
            JobRequest(kind=kind, request=request, program=named, owner="anna"),
        )

    def job(self, id: str) -> Job:
        """As it is now."""
        return jobs.get(self.data_folder, id)

    def over(self, id: str, *, within: float = 60.0) -> Job:
        """As it is once it is over."""

        def look() -> Job | None:
            found = self.job(id)
            return found if found.state.is_finished else None

        return until(look, within=within)

    def runs(self, id: str) -> Job:
        """As it is once it has shown something."""

        def look() -> Job | None:
            found = self.job(id)
            assert not found.state.is_finished, found.problem
            series = self.data_folder.job_folder(id) / "series.bin"
            is_shown = series.exists() and series.stat().st_size > 2000
            return found if found.state is JobState.RUNNING and is_shown else None

        return until(look)


ShopMaker = Callable[[], Shop]


def made_shop(folder: Path) -> Shop:
    shop = Shop(
        data_folder=open_data_folder(folder / "data", knowledge=str(folder / "knowledge.db"))
    )
    with open_store(shop.data_folder.knowledge):
        """made when it is new"""
    sample = SAMPLE.read_bytes()
    shop.program = programs.add(shop.data_folder, sample, name=SAMPLE.name, owner="anna").id
    return shop


@pytest.fixture(scope="session")
def shop(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Shop]:
    """With a runner that nobody may end."""
    made = made_shop(tmp_path_factory.mktemp("shop"))
    with open_store(made.data_folder.knowledge) as store:
        store.add(list(outcomes(300)))
    made.start()
    yield made
    made.end()


@pytest.fixture
def own_shop(tmp_path: Path) -> Iterator[Shop]:
    """Whose runners come and go."""
    made = made_shop(tmp_path)
    yield made
    made.end()
