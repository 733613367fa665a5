"""Properties of shops: legal states, and nothing lost of parts, time and energy."""

import os
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from extras.factory.model.floor import Floor
from extras.factory.model.machining import MachiningPlan
from extras.factory.model.measures import Level, Quantity
from extras.factory.model.records import Listeners, PartMade, StateSpent
from extras.factory.model.shop_figures import measures_of
from extras.factory.model.states import TRANSITIONS, MachineState
from extras.factory.model.streams import Streams
from simulator.errors import Deadlock
from tests.extras.factory.model.shops import Ran, ran, shop_of

SHOP = """
hours = {hours}
warm_up_hours = {warm_up}
start = "Mon 05:00"
[[shift]]
name = "day"
hours = ["Mon-Fri 06:00-14:00", "Sat 22:00-02:00"]
[[machine]]
name = "first"
idle_power_w = 300
count = {firsts}
[machine.handling]
batch_setup_s = {{ kind = "triangular", low = 10, mode = 60, high = 300 }}
batch_setup_w = 900
part_setup_s = 20
part_setup_w = 500
[[machine.failure]]
counts = "clock"
every_h = {{ kind = "weibull", mean = 2, shape = 2 }}
repair_min = {{ kind = "lognormal", mean = 20, variation = 1 }}
scrap = 0.5
[[machine.failure]]
every_h = {{ kind = "exponential", mean = 1 }}
repair_min = 5
scrap = 0.5
[[machine]]
name = "second"
idle_power_w = 200
shift = "day"
[machine.handling]
part_ejection_s = {{ kind = "uniform", low = 5, high = 10 }}
part_ejection_w = 250
batch_ejection_s = 60
batch_ejection_w = 400
[[machine.maintenance]]
every_h = 1.5
takes_min = 12
[[machine.maintenance]]
counts = "clock"
every_h = 3
takes_min = 6
[[buffer]]
name = "between"
capacity = {capacity}
[[crew]]
name = "setters"
members = 1
tasks = ["batch set-up", "part ejection", "repair", "maintenance"]
[[product]]
name = "red"
batch = {batch}
batches = {batches}
arrival_min = {{ kind = "gamma", mean = 30, variation = 0.5 }}
priority = 1
[[product.step]]
machines = ["first"]
time_s = {{ kind = "exponential", mean = 200 }}
power_w = 2000
into = "between"
scrap = 0.1
[[product.step]]
machines = ["second"]
time_s = 150
power_w = 3000
[[product]]
name = "blue"
batch = 3
batches = {batches}
[[product.step]]
machines = ["second", "first"]
time_s = {{ kind = "lognormal", mean = 200, variation = 0.4 }}
power_w = 1500
"""

CASES = st.fixed_dictionaries({
    "hours": st.sampled_from([3, 20, 100]),
    "warm_up": st.sampled_from([0, 2]),
    "firsts": st.integers(1, 3),
    "capacity": st.integers(0, 3),
    "batch": st.integers(1, 6),
    "batches": st.integers(1, 12),
})


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("shops")


def shown(run: Ran) -> list[tuple[object, ...]]:
    """What one run told, to compare it with another."""
    return [tuple(each) for each in run.parts] + [tuple(each) for each in run.states]


def counted(run: Ran) -> range:
    """Number of parts by the counts, less the last of batches that are on a machine."""
    parts = sum(
        each.parts for machine in run.tally.machines for each in machine.processes.values()
    )
    return range(parts - len(run.shop.machines), parts + 1)


@settings(max_examples=40, deadline=None)
@given(case=CASES, seed=st.integers(0, 10))
def test_nothing_is_lost(folder: Path, case: dict[str, int], seed: int) -> None:
    run = ran(shop_of(SHOP.format(**case), folder), seed=seed)
    made = [each for each in run.parts if each.is_good]
    last = {0: 1, 1: 0}
    finished = sum(each.step == last[each.product] for each in made)
    lost = len(run.parts) - len(made)
    sizes = {0: case["batch"], 1: 3}
    entered = sum(stock.released * sizes[row] for row, stock in enumerate(run.floor.raw))
    if run.floor.is_finished:
        assert finished + lost == entered == case["batches"] * (case["batch"] + 3)
    else:
        assert finished + lost <= entered
    if not case["warm_up"]:
        assert run.value(Level.LINE, Quantity.GOOD) <= finished
        assert len(run.parts) in counted(run)
        assert len(run.parts) == counted(run)[-1] or not run.floor.is_finished


@settings(max_examples=40, deadline=None)
@given(case=CASES, seed=st.integers(0, 10))
def test_times_and_energies_add_up(folder: Path, case: dict[str, int], seed: int) -> None:
    run = ran(shop_of(SHOP.format(**case), folder), seed=seed)
    now = run.floor.env.now
    span = max(0.0, now - run.shop.warm_up)
    for machine in run.tally.machines:
        assert sum(machine.seconds.values()) == pytest.approx(span)
    joules = sum(sum(each.joules.values()) for each in run.tally.machines)
    assert run.tally.power.energies().sum() == pytest.approx(joules, abs=1e-3)
    if not case["warm_up"]:
        assert sum(each.energy for each in run.states) == pytest.approx(joules)


@settings(max_examples=30, deadline=None)
@given(case=CASES, seed=st.integers(0, 10))
def test_machines_keep_to_their_chart(folder: Path, case: dict[str, int], seed: int) -> None:
    run = ran(shop_of(SHOP.format(**case), folder), seed=seed)
    for row in range(len(run.shop.machines)):
        own = [each for each in run.states if each.machine == row]
        for before, after in pairwise(own):
            assert after.begin == before.end
            # States without duration are not told: one or two of them may lie between.
            reached = {before.state}
            for _ in range(4):
                if after.state in {to for each in reached for to in TRANSITIONS[each]}:
                    break
                reached |= {to for each in reached for to in TRANSITIONS[each]}
            else:
                pytest.fail(f"{before.state} -> {after.state}")


def test_an_illegal_transition_is_refused(folder: Path) -> None:
    case = {"hours": 3, "warm_up": 0, "firsts": 1, "capacity": 1, "batch": 2, "batches": 2}
    run = ran(shop_of(SHOP.format(**case), folder))
    station = run.floor.stations[0]
    station.book.state = MachineState.PART_SETUP
    with pytest.raises(RuntimeError, match="no transition part set-up -> starved"):
        station.book.enter(MachineState.STARVED, 0.0, run.floor.env.now)


PLAIN = """
hours = 30
{machines}
[[product]]
name = "p"
batch = 4
[[product.step]]
machines = ["a"]
time_s = {{ kind = "exponential", mean = 200 }}
{products}
"""
ROW = """
[[machine]]
name = "{name}"
[machine.handling]
part_setup_s = {{ kind = "uniform", low = 5, high = 9 }}
"""
FAILURE = """
[[machine.failure]]
every_h = { kind = "exponential", mean = 2 }
repair_min = 7
"""
OTHER = '[[product]]\nname = "q"\n[[product.step]]\nmachines = ["b"]\ntime_s = 77\n'


def test_a_machine_added_changes_no_number_of_another(tmp_path: Path) -> None:
    alone = ran(shop_of(PLAIN.format(machines=ROW.format(name="a"), products=""), tmp_path))
    rows = ROW.format(name="b") + ROW.format(name="a")
    both = ran(shop_of(PLAIN.format(machines=rows, products=OTHER), tmp_path))
    own = [each._replace(machine=0, batch=0) for each in both.parts if each.product == 0]
    assert own == [each._replace(batch=0) for each in alone.parts]
    assert len(own) > 400


def test_a_part_in_one_event_is_that_of_three(tmp_path: Path) -> None:
    rows = ROW.format(name="a") + FAILURE
    shop = shop_of(PLAIN.format(machines=rows, products=""), tmp_path)
    found = []
    for began in ((), (lambda _: None,)):
        parts: list[PartMade] = []
        states: list[StateSpent] = []
        listeners = Listeners(part=(parts.append,), state=(states.append,), began=began)
        floor = Floor(shop, MachiningPlan(), Streams(seed=1), listeners)
        floor.run(shop.duration)
        floor.close()
        energy = sum(floor.tally.machines[0].joules.values())
        found.append(([each.end for each in parts], [each.state for each in states], energy))
    assert found[0][0] == pytest.approx(found[1][0])
    assert found[0][1] == found[1][1]
    assert found[0][2] == pytest.approx(found[1][2])
    assert MachineState.REPAIR in found[0][1]


JOINED = """
hours = {hours}
warm_up_hours = {warm_up}
[[machine]]
name = "first"
idle_power_w = 300
count = 2
[machine.handling]
batch_setup_s = {{ kind = "uniform", low = 50, high = 70 }}
batch_setup_w = 900
part_setup_s = {setup}
part_setup_w = 500
part_ejection_s = {{ kind = "uniform", low = 5, high = 10 }}
part_ejection_w = 250
batch_ejection_s = 20
[[machine.failure]]
every_h = {{ kind = "exponential", mean = 3 }}
repair_min = {{ kind = "exponential", mean = 20 }}
scrap = 0.5
[[machine]]
name = "second"
idle_power_w = 200
[[buffer]]
name = "between"
capacity = 1
[[product]]
name = "red"
batch = {batch}
[[product.step]]
machines = ["first"]
time_s = {{ kind = "exponential", mean = 200 }}
power_w = 2000
into = "between"
scrap = 0.1
[[product.step]]
machines = {last}
time_s = {{ kind = "lognormal", mean = 90, variation = 0.5 }}
power_w = 1500
"""


@pytest.mark.parametrize("batch", [1, 7, 300])
@pytest.mark.parametrize("setup", ["0", '{ kind = "uniform", low = 20, high = 30 }'])
@pytest.mark.parametrize("last", ['["second"]', '["second", "first"]'])
@pytest.mark.parametrize("warm_up", [0, 2.3])
def test_batches_in_one_event_are_those_of_their_parts(
    tmp_path: Path, batch: int, setup: str, last: str, warm_up: float
) -> None:
    text = JOINED.format(hours=30, warm_up=warm_up, batch=batch, setup=setup, last=last)
    shop = shop_of(text, tmp_path)
    told: list[int] = []
    joined = Listeners(count=(lambda count, _: told.append(count),))
    alone = Listeners(part=(lambda _: None,))
    floors = []
    for listeners in (joined, alone):
        floor = Floor(shop, MachiningPlan(), Streams(seed=3), listeners)
        for hour in range(1, 31):
            floor.run(hour * 3600.0)
        floors.append(floor)
    one, other = ([each.value for each in measures_of(floor)] for floor in floors)
    assert one == pytest.approx(other, rel=1e-9, nan_ok=True)
    assert floors[0].env.now == floors[1].env.now
    assert (max(told) > 1) == (batch > 1)


def test_all_orders_are_made(tmp_path: Path) -> None:
    rows = ROW.format(name="a")
    text = PLAIN.format(machines=rows, products=OTHER.replace('["b"]', '["a"]'))
    text = text.replace("batch = 4\n", "batch = 4\nbatches = 3\n")
    text = text.replace('name = "q"\n', 'name = "q"\nbatches = 2\n')
    run = ran(shop_of(text, tmp_path))
    assert run.floor.is_finished
    assert [each.product for each in run.parts].count(0) == 12
    assert [each.product for each in run.parts].count(1) == 2


def test_seeds_and_replications_differ_and_repeat(tmp_path: Path) -> None:
    shop = shop_of(PLAIN.format(machines=ROW.format(name="a"), products=""), tmp_path)
    one = shown(ran(shop, seed=1))
    assert shown(ran(shop, seed=1)) == one
    assert shown(ran(shop, seed=2)) != one
    assert shown(ran(shop, seed=1, replication=1)) != one


def test_a_seed_gives_the_same_run_in_every_process(tmp_path: Path) -> None:
    path = tmp_path / "shop.toml"
    path.write_text(PLAIN.format(machines=ROW.format(name="a"), products=""), "utf-8")
    code = (
        "import sys, pathlib, hashlib\n"
        "from tests.extras.factory.model.shops import ran\n"
        "from extras.factory.model.shop_file import read_shop\n"
        "run = ran(read_shop(pathlib.Path(sys.argv[1])))\n"
        "print(hashlib.sha256(repr([tuple(p) for p in run.parts]).encode()).hexdigest())\n"
    )
    found = {
        subprocess.run(
            [sys.executable, "-c", code, str(path)],
            env={**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": os.pathsep.join(sys.path)},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for seed in ("1", "2")
    }
    assert len(found) == 1


LOOP = """
hours = 20
[[machine]]
name = "a"
[[machine]]
name = "b"
[[buffer]]
name = "there"
capacity = {capacity}
[[buffer]]
name = "back"
capacity = {capacity}
[[product]]
name = "p"
[[product.step]]
machines = ["a"]
time_s = 10
into = "there"
[[product.step]]
machines = ["b"]
time_s = 30
into = "back"
[[product.step]]
machines = ["a"]
time_s = 10
"""


def test_a_deadlock_says_who_waits_for_what(tmp_path: Path) -> None:
    # While b works, a takes raw stock again and again, and fills the way there.
    text = LOOP.format(capacity=1).replace('name = "p"', 'name = "p"\narrival_min = 0.1')
    shop = shop_of(text, tmp_path)
    with pytest.raises(Deadlock) as caught:
        ran(shop)
    message = str(caught.value)
    assert "a holds batch" in message
    assert "'there' (1 of 1 batches), which b must empty" in message
    assert "b holds batch" in message
    assert "'back' (1 of 1 batches), which a must empty" in message


def test_a_failure_interrupts_and_the_rest_is_made_later(tmp_path: Path) -> None:
    shop = shop_of(PLAIN.format(machines=ROW.format(name="a"), products=""), tmp_path)

    def ends(fail_at: float | None) -> list[float]:
        parts: list[PartMade] = []
        floor = Floor(
            shop,
            MachiningPlan(),
            Streams(seed=3),
            Listeners(part=(parts.append,), began=(lambda _: None,)),
        )
        if fail_at is not None:
            floor.run(fail_at)
            assert floor.stations[0].fail(600.0)
            assert not floor.stations[0].fail(600.0)
        floor.run(20_000.0)
        return [each.end for each in parts]

    plain = Floor(shop, MachiningPlan(), Streams(seed=3), Listeners())
    with pytest.raises(ValueError, match="nobody listens"):
        plain.stations[0].fail(600.0)
    calm, hit = ends(None), ends(1_000.0)
    for before, after in zip(calm, hit, strict=False):
        assert after == pytest.approx(before if before < 1_000.0 else before + 600.0)
