"""A Dask cluster as an executor: real schedulers and workers, killed at any moment."""

import asyncio
import math
import shutil
import subprocess
import threading
from collections.abc import Iterator
from concurrent.futures import BrokenExecutor, CancelledError, Future
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from benchmarks.local_cluster import LocalCluster, free_port, running_cluster
from extras.factory.model.shop_file import read_shop
from service.execution import cluster as cluster_module
from service.execution.cluster import cluster, versions
from service.execution.executors import processes, results
from service.execution.pools import pools_of
from stepnc_model.errors import StepNcError
from tests.service.execution import work

TASKS = 150


@pytest.fixture(scope="module")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Iterator[LocalCluster]:
    """A cluster that tests leave as it is."""
    with running_cluster(tmp_path_factory.mktemp("cluster"), 1) as made:
        yield made


def test_results_are_those_of_one_process_though_workers_are_killed(tmp_path: Path) -> None:
    place = tmp_path / "shop.toml"
    place.write_text(work.SHOP, encoding="utf-8")
    shop = read_shop(place)
    tasks = [(shop, number) for number in range(TASKS)]
    wanted = dict(
        results(lambda: processes(1), work.replication, tasks, tell=pytest.fail, what="runs")
    )
    moments = sorted(
        np.random.default_rng(8).choice(np.arange(10, TASKS - 50), 3, replace=False)
    )
    found: dict[int, tuple[float, ...]] = {}
    with running_cluster(tmp_path, 3) as made:
        pools = pools_of(made.address)
        for index, row in results(pools, work.replication, tasks, tell=print, what="runs"):
            assert index not in found
            found[index] = row
            if len(found) in moments:
                made.start_worker()
                made.kill_worker()
    assert found == wanted


def test_a_scheduler_that_forgot_everything_is_asked_again(tmp_path: Path) -> None:
    found: dict[int, float] = {}
    told: list[str] = []
    with running_cluster(tmp_path, 1) as made:
        pools = partial(cluster, made.address, patience=60.0)
        tasks = [(0.02,) for _ in range(100)]
        for index, seconds in results(
            pools, work.take_time, tasks, tell=told.append, what="rows"
        ):
            assert index not in found
            found[index] = seconds
            if len(found) == 20:
                made.kill_scheduler()
                made.kill_worker()
                made.start_scheduler()
                made.start_worker()
    assert len(found) == len(tasks)
    assert told


async def lost() -> float:
    """Result of a task whose worker dies while it is fetched."""
    raise CancelledError


def test_a_task_that_is_lost_with_its_worker_ends_its_future() -> None:
    future: Future[float] = Future()
    asyncio.run(cluster_module._finish(lost(), future))
    with pytest.raises(CancelledError):
        future.result(timeout=0.0)


def test_an_error_of_a_task_is_its_own(shared: LocalCluster) -> None:
    with pytest.raises(ValueError, match="math domain error"), cluster(shared.address) as pool:
        pool.submit(math.sqrt, -1.0).result()


def test_a_cluster_that_does_not_answer_is_named() -> None:
    address = f"tcp://127.0.0.1:{free_port()}"
    with (
        pytest.raises(StepNcError, match=f"--cluster {address}: no scheduler answers"),
        cluster(address, patience=0.5),
    ):
        pass


def test_a_cluster_without_workers_is_named(tmp_path: Path) -> None:
    made = LocalCluster(tmp_path)
    try:
        made.start_scheduler()
        with (
            pytest.raises(StepNcError, match="has no worker; start one with `dask worker"),
            cluster(made.address, patience=6.0),
        ):
            pass
    finally:
        made.close()


@pytest.mark.parametrize(
    ("address", "problem"),
    [
        ("tcp://10.1.2.3:8786", "beyond this machine only tls:// is taken"),
        ("tcp://cluster:8786", "beyond this machine only tls:// is taken"),
        ("http://127.0.0.1:8786", "must be tcp://HOST:PORT or tls://HOST:PORT"),
        ("tcp://127.0.0.1", "must be tcp://HOST:PORT"),
        ("tcp://127.0.0.1:99999999", "must be tcp://HOST:PORT"),
        ("tls://10.1.2.3:8786", "ca-file is not set in Dask's configuration"),
    ],
)
def test_addresses_that_are_not_usable_are_refused_before_anything_is_done(
    address: str, problem: str
) -> None:
    with pytest.raises(StepNcError, match=problem):
        pools_of(address)


def test_workers_of_another_version_are_refused(
    shared: LocalCluster, monkeypatch: pytest.MonkeyPatch
) -> None:
    own = versions() | {"stepnc-optimiser": "0.0.1"}
    monkeypatch.setattr(cluster_module, "versions", OtherVersions(own))
    with pytest.raises(StepNcError, match=r"has stepnc-optimiser \S+, here it is 0\.0\.1"):
        pools_of(shared.address)


class OtherVersions:
    """Versions here; workers tell their own."""

    def __init__(self, own: dict[str, str]) -> None:
        self._own = own

    def __call__(self) -> dict[str, str]:
        return self._own

    def __reduce__(self) -> tuple[object, tuple[()]]:
        return _theirs, ()


def _theirs() -> object:
    return versions


def test_an_error_of_the_work_is_that_of_the_caller(shared: LocalCluster) -> None:
    with pytest.raises(ValueError, match="number 4"):
        list(results(pools_of(shared.address), work.refuse, [(4,)], tell=print, what="numbers"))


def test_an_encrypted_cluster_runs_work(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import dask  # noqa: PLC0415

    openssl = shutil.which("openssl")
    assert openssl, "openssl makes the certificate"
    key, certificate = tmp_path / "key.pem", tmp_path / "cert.pem"
    subprocess.run(
        [openssl, "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj",
         "/CN=cluster", "-keyout", str(key), "-out", str(certificate)],
        check=True, capture_output=True,
    )  # fmt: skip
    cert = str(certificate)
    options = ("--tls-ca-file", cert, "--tls-cert", cert, "--tls-key", str(key))
    files = {"ca-file": str(certificate)}
    files |= {
        f"client.{each}": str(path) for each, path in (("cert", certificate), ("key", key))
    }
    config = {f"distributed.comm.tls.{name}": value for name, value in files.items()}
    made = LocalCluster(tmp_path, options)
    try:
        made.start_scheduler()
        made.start_worker()
        with dask.config.set(config):
            made.wait(1)
            pools = pools_of(made.address)
            found = results(pools, work.square, [(3,)], tell=print, what="squares")
            assert list(found) == [(0, 9)]
    finally:
        made.close()


def test_no_thread_of_a_cluster_is_left(shared: LocalCluster) -> None:
    pools = pools_of(shared.address)
    before = threading.active_count()
    for _ in range(2):
        assert list(results(pools, work.square, [(2,)], tell=print, what="squares")) == [(0, 4)]
    assert threading.active_count() <= before + 1


class AwayClient:
    """Client of a scheduler that left after it was reached."""

    def __init__(self, *_: object, **__: object) -> None: ...

    def wait_for_workers(self, *_: object, **__: object) -> None: ...

    def run(self, *_: object, **__: object) -> dict[str, object]:
        return {}

    def close(self, **_: object) -> None:
        raise TimeoutError


@pytest.mark.parametrize("call", ["wait_for_workers", "run", "close"])
def test_a_scheduler_that_leaves_is_named(monkeypatch: pytest.MonkeyPatch, call: str) -> None:
    """Dask's errors are OSErrors without a reason, as of any file."""
    address = "tcp://127.0.0.1:8786"

    def gone(*_: object, **__: object) -> None:
        raise OSError

    monkeypatch.setattr("distributed.Client", AwayClient)
    with monkeypatch.context() as patch:
        if call != "close":
            patch.setattr(AwayClient, call, gone)
        with pytest.raises((StepNcError, BrokenExecutor)) as caught, cluster(address):
            raise TimeoutError
    if call != "close":
        assert address in str(caught.value)
