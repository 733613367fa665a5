"""A live shop, without a clock: what it tells, and what it obeys."""

from collections import Counter
from pathlib import Path

import pytest

from extras.factory.live import LiveShop, ShopEventKind, require_failure
from extras.factory.model.machining import MachiningPlan
from extras.factory.model.records import Listeners
from extras.factory.model.shop_figures import measures_of
from extras.factory.model.states import MachineState
from extras.factory.model.streams import Streams
from extras.factory.replications import run_shop
from extras.factory.state_log import STATES
from stepnc_model.errors import StepNcError
from tests.every_case import every_case
from tests.extras.factory.shops import timed_shop


def live_shop(folder: Path, *, hours: float = 2.0) -> LiveShop:
    return LiveShop(timed_shop(folder, hours=hours), MachiningPlan(), seed=3, programs={})


def steps(live: LiveShop, *times: float) -> None:
    for time in times:
        live.advance(time)


def machine(live: LiveShop, name: str) -> dict[str, object]:
    return next(each for each in live.snapshot()["machines"] if each["name"] == name)


def test_advanced_in_steps_it_ends_with_the_figures_of_one_run(tmp_path: Path) -> None:
    live = live_shop(tmp_path)
    while live.advance(live.time + 37.0):
        pass
    shop = live.shop
    whole = run_shop(shop, MachiningPlan(), Streams(seed=3), listeners=Listeners())
    assert measures_of(live.floor) == whole.measures
    assert live.is_done
    assert live.snapshot()["is_done"]
    assert not live.advance(1e9)
    assert live.time == shop.duration


def test_energy_and_times_of_the_status_include_the_present_state(tmp_path: Path) -> None:
    live = live_shop(tmp_path)
    steps(live, 30.0)
    saw = machine(live, "saw 1")
    # 10 s of set-up with 300 W, then 20 s of 1000 W.
    assert saw["state"] == "machining"
    assert saw["energy_kwh"] == pytest.approx((10 * 300 + 20 * 1000) / 3.6e6)
    assert saw["seconds"] == pytest.approx({"part set-up": 10.0, "machining": 20.0})
    assert saw["progress"] == pytest.approx(20.0 / 50.0)
    assert (saw["batch"], saw["part"], saw["product"], saw["step"]) == (0, 0, "plate", 1)
    line = live.snapshot()["line"]
    assert line["power_kw"] == pytest.approx((1000 + 2 * 500) / 1000)
    assert line["energy_kwh"] == pytest.approx((23_000 + 2 * 500 * 30) / 3.6e6)


def test_rows_hold_powers_and_energy(tmp_path: Path) -> None:
    live = live_shop(tmp_path)
    steps(live, 5.0, 30.0)
    rows = live.taken().rows
    assert live.columns[:3] == ("time_s", "power_kw", "energy_kwh")
    assert live.columns[5:] == ("power_w:saw 1", "power_w:mill-1", "power_w:mill-2")
    assert rows[:, 0].tolist() == [0.0, 5.0, 30.0]
    assert rows[:, 5].tolist() == pytest.approx([200.0, 300.0, (5 * 300 + 20 * 1000) / 25])
    assert rows[-1, 2] == pytest.approx((23_000 + 2 * 500 * 30) / 3.6e6)
    assert live.taken().rows.shape == (0, len(live.columns))


def test_changes_of_state_tile_the_time(tmp_path: Path) -> None:
    live = live_shop(tmp_path)
    steps(live, 3600.0)
    seconds: Counter[str] = Counter()
    last: dict[int, tuple[float, MachineState]] = {}
    for time, row, number in live.changes().tolist():
        if row in last:
            begin, state = last[int(row)]
            seconds[f"{int(row)} {state.value}"] += time - begin
        last[int(row)] = (time, STATES[int(number)])
    for row, (begin, state) in last.items():
        seconds[f"{row} {state.value}"] += 3600.0 - begin  # type: ignore[assignment]
    for row, each in enumerate(live.snapshot()["machines"]):
        for state, time in each["seconds"].items():
            assert seconds[f"{row} {state}"] == pytest.approx(time)
    assert live.changes().shape == (0, 3)


def test_an_ordered_failure_is_told_repaired_and_counted(tmp_path: Path) -> None:
    live = live_shop(tmp_path)
    steps(live, 30.0)
    live.obey({"machine": "saw 1", "repair_min": 5.0})
    steps(live, 31.0)
    assert machine(live, "saw 1")["state"] == "repair"
    progress = machine(live, "saw 1")["progress"]
    with pytest.raises(StepNcError, match="cannot fail now: it is in the state 'repair'"):
        live.obey({"machine": "saw 1", "repair_min": 5.0})
    steps(live, 300.0, 331.0)
    found = machine(live, "saw 1")
    assert found["state"] == "machining"
    assert found["seconds"]["repair"] == pytest.approx(300.0)  # type: ignore[index]
    # What was cut before the failure stays cut.
    assert progress == pytest.approx(0.4)
    assert found["progress"] == pytest.approx(0.42)
    kinds = [event.kind for event in live.taken().events]
    assert kinds == [
        ShopEventKind.ORDER, ShopEventKind.FAILED, ShopEventKind.REPAIR, ShopEventKind.REPAIRED,
    ]  # fmt: skip


def test_an_order_to_end_ends_it(tmp_path: Path) -> None:
    live = live_shop(tmp_path)
    steps(live, 30.0)
    live.obey({"end": True})
    assert not live.advance(60.0)
    assert live.time == 30.0
    assert [event.kind for event in live.taken().events] == [ShopEventKind.OVER]


def test_a_blocked_machine_shows_the_step_that_it_has_made(tmp_path: Path) -> None:
    live = live_shop(tmp_path)
    while machine(live, "saw 1")["state"] != "blocked":
        assert live.advance(live.time + 10.0)
    assert machine(live, "saw 1")["step"] == 1
    (buffer,) = live.snapshot()["buffers"]
    assert (buffer["level"], buffer["offered"], buffer["capacity"]) == (1, 1, 1)
    assert (buffer["stage"], machine(live, "mill-1")["stage"]) == (0, 1)


@every_case(
    ("name", "minutes", "text"),
    [
        ("lathe", 5.0, "unknown machine 'lathe'; known: saw 1, mill-1"),
        ("saw 1", 0.0, "repair 0 min: it must be above 0 to 10000 min"),
        ("saw 1", 1e9, "repair 1e"),
        ("saw 1", float("nan"), "repair nan min"),
    ],
)
def test_an_impossible_failure_is_refused(name: str, minutes: float, text: str) -> None:
    with pytest.raises(StepNcError, match=text):
        require_failure(("saw 1", "mill-1"), name, minutes)
