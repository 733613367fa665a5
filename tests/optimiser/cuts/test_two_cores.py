"""Two processes give what one gives, whatever meets what."""

import os
import threading
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

from benchmarks.plates import plate
from optimiser.advice import Plan
from optimiser.cuts import two_cores as module
from optimiser.cuts.two_cores import LEAST, one_by_one, side_by_side
from optimiser.modes import Mode
from optimiser.optimise import optimise_program
from optimiser.planning.formulate import OptimisationTask
from simulator.library import load_machine, match_material
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program, ResolvedWorkingstep

FEW = 5
"""workingsteps of a half that go to another process in a program that is really planned"""

pytestmark = pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")


@pytest.fixture(autouse=True)
def _two_cores(monkeypatch: pytest.MonkeyPatch) -> None:
    """Also where the runner of the tests has threads or one core."""
    monkeypatch.setattr(module, "_is_possible", lambda: True)
    monkeypatch.setattr(module, "SOON", 30.0)


@dataclass
class Shelf:
    """Numbers that steps raise, each at a place of its own."""

    places: dict[int, int]
    """place by step"""
    content: dict[int, int] = field(default_factory=dict)
    last: tuple[int, int] = (0, 0)
    done_here: list[int] = field(default_factory=list)

    def do(self, step: Any) -> tuple[int, int]:
        if step < 0:
            raise ValueError(f"step {step}")
        place = self.places.get(step, 1000 + step)
        self.content[place] = 2 * self.content.get(place, step) + 1
        self.last = place, self.content[place]
        self.done_here.append(step)
        return step, self.content[place]

    def split(self) -> None:
        pass

    def trace(self) -> tuple[int, int]:
        return self.last

    def is_apart(
        self,
        step: ResolvedWorkingstep,
        trace: tuple[int, int],
        others: Sequence[tuple[int, int]],
    ) -> bool:
        return all(trace[0] != other[0] for other in others)

    def repeat(self, step: ResolvedWorkingstep, trace: tuple[int, int]) -> None:
        self.content[trace[0]] = trace[1]


def both(steps: Any, places: dict[int, int]) -> tuple[Shelf, list[Any]]:
    """The state after two processes, and the results, which are those of one."""
    one, two = Shelf(places), Shelf(places)
    expected = list(one_by_one(steps, one.do))
    found = list(side_by_side(steps, two.do, two))
    assert found == expected
    assert two.content == one.content
    return two, found


def test_apart_a_half_is_done_elsewhere() -> None:
    shelf, _ = both(list(range(2 * LEAST)), {})
    assert shelf.done_here == list(range(LEAST))


@pytest.mark.parametrize("count", [0, 1, 2 * LEAST - 1])
def test_few_are_done_here(count: int) -> None:
    shelf, _ = both(list(range(count)), {})
    assert shelf.done_here == list(range(count))


def test_what_meets_is_done_again() -> None:
    places = {3: 7, LEAST + 5: 7, LEAST + 9: 7}
    shelf, _ = both(list(range(2 * LEAST)), places)
    assert shelf.done_here[LEAST:] == [LEAST + 5, LEAST + 9]


def test_a_late_process_is_not_waited_for() -> None:
    """The second process sleeps at each step, and only there."""
    here = os.getpid()

    def do(step: Any) -> int:
        if os.getpid() != here:
            time.sleep(600.0)
        return int(step)

    steps: Any = list(range(2 * LEAST))
    begin = time.monotonic()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "SOON", 0.01)
        assert list(side_by_side(steps, do, Shelf({}))) == steps
    assert time.monotonic() - begin < 120.0


def test_where_all_meet_it_is_tried_ever_more_rarely() -> None:
    count = 40 * LEAST
    forks = 0
    fork = os.fork

    def counted() -> int:
        nonlocal forks
        forks += 1
        return fork()

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, "fork", counted)
        both(list(range(count)), dict.fromkeys(range(count), 7))
    assert 2 <= forks <= 5


def test_the_first_error_is_that_of_one_process() -> None:
    steps = list(range(2 * LEAST))
    steps[LEAST + 3], steps[LEAST + 6] = -3, -6
    shelf = Shelf({})
    with pytest.raises(ValueError, match="step -3"):
        list(side_by_side(steps, shelf.do, shelf))  # type: ignore[arg-type]
    results = side_by_side(steps, Shelf({}).do, Shelf({}))  # type: ignore[arg-type]
    assert len([*_until_error(results)]) == LEAST + 3


def _until_error(results: Iterator[Any]) -> Iterator[Any]:
    try:
        yield from results
    except ValueError:
        return


def test_who_looks_away_leaves_no_process() -> None:
    before = children()
    results = side_by_side(list(range(2 * LEAST)), lambda step: time.sleep(0.01), Shelf({}))  # type: ignore[arg-type]
    next(results)
    assert children() > before
    results.close()  # type: ignore[attr-defined]
    assert children() == before


def children() -> set[str]:
    """Processes that this thread has started, ended ones that nobody waited for too."""
    own = Path(f"/proc/self/task/{threading.get_native_id()}/children")
    return set(own.read_text().split())


def planned(text: str) -> Plan:
    """Advice for a program."""
    program = Program(Part21File.from_bytes(text.encode(), name="plate"), name="plate")
    return optimise_program(
        program,
        machine=load_machine("vmc15"),
        material=match_material(["C45"]),
        task=OptimisationTask(mode=Mode.TC),
    )


def test_a_program_whose_workingsteps_meet_here_and_there(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Pockets of 60 mm every 70 mm; every third of the second half lies on two of the first."""
    monkeypatch.setattr(module, "LEAST", FEW)
    text = plate(2 * FEW + 4)
    for number in range(FEW + 4, 2 * FEW + 4, 3):
        x, y = text.split(f"#{1000 + 10 * (number - 7) + 3}=CARTESIAN_POINT('',(")[1].split(
            ","
        )[:2]
        own = f"#{1000 + 10 * number + 3}=CARTESIAN_POINT('',("
        head, tail = text.split(own)
        text = f"{head}{own}{float(x) + 25.0},{y},0.));{tail[tail.index(';') + 1 :]}"
    two = planned(text)
    monkeypatch.setattr(module, "_is_possible", lambda: False)
    assert planned(text) == two
