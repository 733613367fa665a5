"""A real server that all tests of this folder share; nobody may end it or fill it up."""

from collections.abc import Iterator
from dataclasses import asdict, dataclass

import httpx
import pytest

from kbe.store import open_store
from tests.extras.factory.shops import TIMED
from tests.extras.verification.logs import SLOT_MACHINE, slot_log
from tests.service.rest.samples import SAMPLE, SLOT
from tests.service.rest.server import Server, made, over
from tests.service.shop import outcomes


@pytest.fixture(scope="session")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """With some outcomes in its knowledge base."""
    server = Server(tmp_path_factory.mktemp("service"), "--upload-mb", "4", "--jobs", "2")
    server.data.mkdir(parents=True)
    with open_store(str(server.data / "knowledge.db")) as store:
        store.add(list(outcomes(300)))
    with server:
        yield server
        assert server.faults() == ""


@pytest.fixture
def client(service: Server) -> Iterator[httpx.Client]:
    with service.client() as found:
        yield found


@dataclass(frozen=True, slots=True, kw_only=True)
class Done:
    """Ids of what was made once, and is only looked at."""

    program: str
    advice: str
    simulation: str
    control: str
    trial: str
    evaluation: str
    review: str
    file: str
    verification: str
    cycle: str
    factory: str


OF = {
    "programs": "program", "advice": "advice", "simulations": "simulation",
    "control-runs": "control", "trials": "trial", "evaluations": "evaluation",
    "reviews": "review", "jobs": "simulation", "verifications": "verification",
    "files": "file", "cycle-times": "cycle", "factories": "factory",
}  # fmt: skip
"""What of the things that were made is at a path."""


def id_of(done: Done, path: str) -> str:
    """Id of the thing that was made of the kind of a path."""
    return str(asdict(done)[OF[path.split("/")[2]]])


@pytest.fixture(scope="session")
def log(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """Positions of the slot, cut too deep."""
    return slot_log(tmp_path_factory.mktemp("log") / "run.parquet", lower=0.1).read_bytes()


@pytest.fixture(scope="session")
def done(service: Server, log: bytes) -> Done:
    """One job of each kind that has succeeded."""
    with service.client() as client:
        program = made(
            client.post("/v1/programs?name=part.stpnc", content=SAMPLE.read_bytes()), 201
        )
        slot = made(client.post("/v1/programs?name=slot.stpnc", content=SLOT.read_bytes()), 201)
        file = made(client.post("/v1/files?name=run.parquet", content=log), 201)
        asked = {
            "advice": (
                f"/v1/programs/{program}/advice",
                {"nc_control": "linuxcnc", "machine": "vmc15", "is_confirmed": True},
            ),
            "simulation": ("/v1/simulations", {"program_id": program}),
            "control": ("/v1/control-runs", {"program_id": program, "pace": 0.0}),
            "trial": ("/v1/trials", {"pace": 100.0}),
            "evaluation": ("/v1/evaluations", {}),
            "review": ("/v1/reviews", {}),
            "factory": ("/v1/factories", {"shop": TIMED.format(hours=1), "pace": 1000.0}),
            "cycle": (
                "/v1/cycle-times",
                {"program_id": slot, "log_id": file, "machine": SLOT_MACHINE},
            ),
            "verification": (
                "/v1/verifications",
                {
                    "program_id": slot,
                    "log_id": file,
                    "machine": SLOT_MACHINE,
                    "cell_mm": 0.5,
                },
            ),
        }
        ids = {name: made(client.post(path, json=body)) for name, (path, body) in asked.items()}
        made_end = client.post(f"/v1/trials/{ids['trial']}/changes", json={"end": True})
        assert made_end.status_code == 202
        for id in ids.values():
            job = over(client, id)
            assert job["state"] == "succeeded", job
    return Done(program=program, file=file, **ids)
