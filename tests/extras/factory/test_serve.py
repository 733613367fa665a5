"""``stepnc factory --live`` as clients meet it, over loopback."""

import re
import signal
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from subprocess import DEVNULL, Popen

import httpx
import pyarrow.parquet as pq
import pytest

from extras.factory.requests import FactoryRequest
from extras.factory.serve import begin_of, require_live
from service.recording.request import RecordingRequest
from service.recording.run import Recording, record
from simulator.client.connection import AgentClient
from stepnc_model.errors import StepNcError
from tests.extras.agent.model.conftest import require_valid
from tests.extras.factory.shops import program_file
from tests.service.waiting import ended, environment, until

STEPNC = Path(sys.executable).with_name("stepnc")

DEVICES = ("saw", "mill-1", "mill-2")

SPEED = 400


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Address of a shop that runs at a fast pace."""
    folder = tmp_path_factory.mktemp("live")
    log = folder / "log"
    words = [str(STEPNC), "factory", str(program_file(folder, hours=20.0)), "--live",
             "--speed", str(SPEED), "--port", "0"]  # fmt: skip
    with log.open("wb") as stream:
        process = Popen(words, stdin=DEVNULL, stdout=DEVNULL, stderr=stream,
                        env=environment(folder))  # fmt: skip
    try:

        def found() -> str:
            assert process.poll() is None, log.read_text()
            place = re.search(r"MTConnect agent: (http://\S+)/current", log.read_text())
            return place[1] if place else ""

        yield until(found)
    finally:
        process.send_signal(signal.SIGINT)
        code = ended(process)
    assert code in {0, 130}, log.read_text()
    assert "Traceback" not in log.read_text()


def test_three_machines_of_a_running_shop_are_recorded_at_once(
    address: str, tmp_path: Path
) -> None:
    request = RecordingRequest(duration_s=3.0)

    def recorded(name: str) -> Recording:
        return record(f"{address}/{name}", tmp_path / f"{name}.parquet", request)

    with ThreadPoolExecutor(len(DEVICES)) as pool:
        found = dict(zip(DEVICES, pool.map(recorded, DEVICES), strict=True))
    for name, recording in found.items():
        assert recording.rows > 3, name
        assert recording.lost == recording.faults == recording.restarts == 0
    mill = pq.read_table(tmp_path / "mill-1.parquet").to_pydict()
    assert len(set(mill["x_axis_position_actual"])) > 5, sorted(mill)


def test_each_machine_is_a_device_of_one_valid_document(address: str) -> None:
    client = AgentClient(address)
    devices = {item.device for item in client.items()}
    assert set(DEVICES) <= devices
    with httpx.Client(trust_env=False, timeout=120.0) as asking:
        for kind in ("probe", "current", "sample?count=500"):
            require_valid(asking.get(f"{address}/{kind}").content, "2.7")


def test_parts_are_counted_and_named_while_it_runs(address: str) -> None:
    with httpx.Client(trust_env=False, timeout=120.0) as asking:

        def count() -> int:
            text = asking.get(f"{address}/mill-1/current").text
            found = re.search(r'mill-1_parts"[^>]*>(\d+)<', text)
            return int(found[1]) if found else 0

        first = until(count)
        until(lambda: count() > first)
        text = asking.get(f"{address}/mill-1/sample?count=10000").text
    assert re.search(r'mill-1_part"[^>]*>\d+-\d<', text)
    assert re.search(r'mill-1_program"[^>]*>paper003_case1.stpnc<', text)
    assert re.search(r'mill-1_exec"[^>]*>ACTIVE<', text)


def test_stamps_do_not_pass_the_clock() -> None:
    assert begin_of(3600.0, 60.0) < begin_of(3600.0, 2.0) < begin_of(3600.0, 0.5)


@pytest.mark.parametrize("words", [{"replications": 2}, {"documents": 1}, {"sweep": ("a=1",)}])
def test_what_a_live_shop_does_not_do_is_refused(words: dict[str, object]) -> None:
    with pytest.raises(StepNcError, match="leave out"):
        require_live(FactoryRequest(**words))  # type: ignore[arg-type]
