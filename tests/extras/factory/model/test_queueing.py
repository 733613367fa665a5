"""Shops beside closed forms of queueing theory, within 99.9 % intervals of 30 replications.

References
----------
.. [1] L. Kleinrock, "Queueing Systems", vol. 1, 1975: M/M/1 (3.24), M/M/m (3.40), M/G/1 (5.63).
.. [2] S. B. Gershwin, O. Berman, "Analysis of transfer lines consisting of two unreliable
   machines with random processing times and finite storage buffers", AIIE Transactions 13
   (1981) 2-11: the chain of states, solved here as linear equations.
"""

from math import factorial
from pathlib import Path

import numpy as np
import pytest

from extras.factory.model.measures import Level, Quantity
from tests.extras.factory.model.shops import Figure, intervals, ran, shop_of

QUEUE = """
hours = 200
warm_up_hours = 40
[[machine]]
name = "server"
count = {machines}
[[product]]
name = "customer"
arrival_min = {{ kind = "exponential", mean = {between} }}
[[product.step]]
machines = ["server"]
time_s = {{ kind = "{kind}", mean = {service}, {more} }}
"""


def queue(
    folder: Path, *, machines: int = 1, kind: str = "exponential", more: str = ""
) -> tuple[float, float]:
    """Mean number of customers, and its half-width; 10 min apart, 7 min of service each."""
    text = QUEUE.format(
        machines=machines, between=10.0 / machines, kind=kind, service=420.0, more=more
    ).replace(",  }", " }")
    return intervals(shop_of(text, folder), (Level.LINE, Quantity.WIP, ""))[0]


def test_one_exponential_server(tmp_path: Path) -> None:
    mean, half = queue(tmp_path)
    load = 0.7
    assert mean == pytest.approx(load / (1.0 - load), abs=half)
    assert half < 0.4


def test_three_exponential_servers(tmp_path: Path) -> None:
    mean, half = queue(tmp_path, machines=3)
    load, servers = 0.7, 3
    offered = load * servers
    waiting = offered**servers / factorial(servers) / (1.0 - load)
    whole = waiting + sum(offered**row / factorial(row) for row in range(servers))
    assert mean == pytest.approx(offered + waiting / whole * load / (1.0 - load), abs=half)
    assert half < 0.4


@pytest.mark.parametrize("variation", [0.3, 1.5])
def test_one_server_with_any_service_time(tmp_path: Path, variation: float) -> None:
    mean, half = queue(tmp_path, kind="gamma", more=f"variation = {variation}")
    load = 0.7
    # Pollaczek and Khinchine
    expected = load + load**2 * (1.0 + variation**2) / (2.0 * (1.0 - load))
    assert mean == pytest.approx(expected, abs=half)
    assert half < 0.9


THROUGHPUT: Figure = (Level.LINE, Quantity.THROUGHPUT, "")

LINE = """
hours = 150
warm_up_hours = 20
[[machine]]
name = "first"
[[machine.failure]]
every_h = { kind = "exponential", mean = 2.0 }
repair_min = { kind = "exponential", mean = 20 }
[[machine]]
name = "second"
[[machine.failure]]
every_h = { kind = "exponential", mean = 1.0 }
repair_min = { kind = "exponential", mean = 12 }
[[buffer]]
name = "between"
capacity = 4
[[product]]
name = "part"
[[product.step]]
machines = ["first"]
time_s = { kind = "exponential", mean = 100 }
into = "between"
[[product.step]]
machines = ["second"]
time_s = { kind = "exponential", mean = 110 }
"""


def two_machines(capacity: int) -> tuple[float, float]:
    """Throughput in parts/h and mean level of the buffer of [2]_.

    A state is the number of parts behind the first operation, and whether each machine is up.
    The first machine is blocked with capacity + 2 of them: its own, and that on the second.
    Machines fail while they work.
    """
    made, fails, repairs = (1 / 100, 1 / 110), (1 / 7200, 1 / 3600), (1 / 1200, 1 / 720)
    most = capacity + 2
    states = [(k, a, b) for k in range(most + 1) for a in (0, 1) for b in (0, 1)]
    index = {state: row for row, state in enumerate(states)}
    rates = np.zeros((len(states), len(states)))

    def flow(state: tuple[int, int, int], after: tuple[int, int, int], rate: float) -> None:
        rates[index[state], index[after]] += rate
        rates[index[state], index[state]] -= rate

    for k, a, b in states:
        if k < most and a:
            flow((k, a, b), (k + 1, a, b), made[0])
            flow((k, a, b), (k, 0, b), fails[0])
        if k > 0 and b:
            flow((k, a, b), (k - 1, a, b), made[1])
            flow((k, a, b), (k, a, 0), fails[1])
        if not a:
            flow((k, a, b), (k, 1, b), repairs[0])
        if not b:
            flow((k, a, b), (k, a, 1), repairs[1])
    table = np.vstack([rates.T, np.ones(len(states))])
    share = np.linalg.lstsq(table, np.append(np.zeros(len(states)), 1.0), rcond=None)[0]
    busy = sum(share[index[each]] for each in states if each[0] > 0 and each[2])
    level = sum(share[index[each]] * min(max(each[0] - 1, 0), capacity) for each in states)
    return 3600.0 * made[1] * float(busy), float(level)


def test_two_machines_that_fail_with_a_buffer_between(tmp_path: Path) -> None:
    shop = shop_of(LINE, tmp_path)
    throughput, level = two_machines(4)
    (rate, half), (mean, apart) = intervals(
        shop, THROUGHPUT, (Level.BUFFER, Quantity.LEVEL, "between")
    )
    assert rate == pytest.approx(throughput, abs=half)
    assert half < 0.03 * throughput
    assert mean == pytest.approx(level, abs=apart)
    assert apart < 0.15 * level


def test_no_buffer_hands_over_from_machine_to_machine(tmp_path: Path) -> None:
    shop = shop_of(LINE.replace("capacity = 4", "capacity = 0"), tmp_path)
    mean, half = intervals(shop, THROUGHPUT)[0]
    assert mean == pytest.approx(two_machines(0)[0], abs=half)


def test_little(tmp_path: Path) -> None:
    text = LINE.replace('name = "part"\n', 'name = "part"\nbatch = 5\narrival_min = 12\n')
    run = ran(shop_of(text.replace("hours = 150", "hours = 3000"), tmp_path))
    inside, rate = (run.value(Level.LINE, each) for each in (Quantity.WIP, Quantity.THROUGHPUT))
    assert inside == pytest.approx(rate * run.value(Level.LINE, Quantity.LEAD_TIME), rel=5e-3)
