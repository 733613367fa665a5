"""Rows of runs in as many points as are wanted."""

import asyncio
from threading import Barrier, Lock

import httpx

from service.rest.results import READERS, read_in_turn
from tests.every_case import every_case
from tests.service.rest.conftest import Done
from tests.service.rest.server import is_problem


def test_a_series_is_reduced_to_the_points_that_were_asked_for(
    client: httpx.Client, done: Done
) -> None:
    path = f"/v1/simulations/{done.simulation}/series"
    whole = client.get(f"{path}?points=5000&signals=cutting_force_n,x_mm").json()
    few = client.get(f"{path}?points=10&signals=cutting_force_n").json()
    assert not whole["is_growing"]
    assert few["is_reduced"]
    assert len(few["begin_s"]) == len(few["end_s"]) == 10
    assert list(whole["signals"]) == ["cutting_force_n", "x_mm"]
    high = [value for value in whole["signals"]["cutting_force_n"]["high"] if value is not None]
    assert max(few["signals"]["cutting_force_n"]["high"]) == max(high)
    assert set(whole["signals"]) <= set(whole["columns"])


def test_a_range_is_cut_out(client: httpx.Client, done: Done) -> None:
    path = f"/v1/control-runs/{done.control}/series"
    part = client.get(f"{path}?begin_s=2&end_s=3").json()
    assert part["rows"] > 0
    assert min(part["begin_s"]) >= 2.0
    assert max(part["end_s"]) <= 3.0
    nothing = client.get(f"{path}?begin_s=1e9").json()
    assert (nothing["rows"], nothing["begin_s"]) == (0, [])


@every_case(
    "query",
    ["points=0", "points=5001", "points=x", "begin_s=nan", "end_s=inf", "begin_s=-inf",
     "signals=" + "x" * 1001],
)  # fmt: skip
def test_what_cannot_be_is_refused(client: httpx.Client, done: Done, query: str) -> None:
    for path in (f"simulations/{done.simulation}", f"trials/{done.trial}"):
        is_problem(client.get(f"/v1/{path}/series?{query}"), 422)


def test_a_range_that_ends_before_it_begins_is_refused(
    client: httpx.Client, done: Done
) -> None:
    path = f"/v1/trials/{done.trial}/series"
    is_problem(client.get(f"{path}?begin_s=3&end_s=2"), 400, "unreadable")
    is_problem(client.get(f"{path}?signals=none"), 404, "not-found")
    assert client.get(f"{path}?signals=,,").status_code == 200


def test_a_series_is_of_its_own_kind(client: httpx.Client, done: Done) -> None:
    is_problem(client.get(f"/v1/trials/{done.control}/series"), 404)
    is_problem(client.get(f"/v1/control-runs/{done.simulation}/series"), 404)


def test_few_read_all_rows_of_a_run_at_once() -> None:
    most = int(READERS.total_tokens)
    together, lock, counts = Barrier(most), Lock(), [0, 0]

    def read(number: int) -> int:
        with lock:
            counts[0] += 1
            counts[1] = max(counts)
        together.wait(120.0)
        with lock:
            counts[0] -= 1
        together.wait(120.0)
        return number

    async def ask() -> list[int]:
        return await asyncio.gather(*(read_in_turn(read, number) for number in range(6)))

    assert asyncio.run(ask()) == list(range(6))
    assert counts == [0, most]
