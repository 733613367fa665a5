"""Several programs write to one store at once, and one of them may die."""

import pickle
import subprocess
import sys
from collections import Counter
from collections.abc import Callable

from kbe.queries import Selection
from kbe.store import open_store
from stepnc_model.outcome import ProcessOutcome
from tests.service.waiting import ended

OutcomeMaker = Callable[..., list[ProcessOutcome]]

WRITER = """
import pickle, sys
from kbe.store import open_store
outcomes = pickle.load(sys.stdin.buffer)
with open_store(sys.argv[1]) as store:
    for number, outcome in enumerate(outcomes, start=1):
        store.add([outcome])
        print(number, flush=True)
"""


def started(url: str, outcomes: list[ProcessOutcome]) -> "subprocess.Popen[bytes]":
    """A program that commits these one by one and tells the number of each when it is kept."""
    program = subprocess.Popen(
        [sys.executable, "-c", WRITER, url], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    )
    assert program.stdin is not None
    program.stdin.write(pickle.dumps(outcomes))
    program.stdin.close()
    return program


def test_four_programs_lose_nothing_and_keep_nothing_twice(
    url: str, outcomes: OutcomeMaker
) -> None:
    """The store is new: they make it at once, too."""
    runs = [outcomes(50, run=f"run-{index}") for index in range(4)]
    programs = [started(url, run) for run in runs]
    assert [ended(program) for program in programs] == [0] * 4
    with open_store(url) as store:
        kept = Counter(outcome.workingstep for outcome in store.outcomes())
        assert kept == Counter(outcome.workingstep for run in runs for outcome in run)
        store.check()
    for program in programs:
        assert program.stdout is not None
        program.stdout.close()


def test_killed_program_loses_nothing_that_it_was_told_is_kept(
    url: str, outcomes: OutcomeMaker
) -> None:
    """Killed in the middle of writing, twice, while another goes on."""
    other = started(url, outcomes(60, run="other"))
    for attempt in range(2):
        run = f"run-{attempt}"
        program = started(url, outcomes(1000, run=run))
        assert program.stdout is not None
        for wanted in range(1, 8 + 10 * attempt):
            assert int(program.stdout.readline()) == wanted
        program.kill()
        told = max(map(int, program.stdout.read().split()), default=wanted)
        program.stdout.close()
        assert ended(program) == -9
        with open_store(url) as store:
            store.check()
            steps = [each.workingstep for each in store.outcomes(Selection(run=run))]
        # One more may have been kept before it could say so.
        assert len(steps) in {told, told + 1}
        assert steps == [f"{run} WS{index}" for index in range(len(steps))]
    assert ended(other) == 0
    with open_store(url) as store:
        assert store.count(Selection(run="other")) == 60
        store.add(outcomes(1, run="after"))
    assert other.stdout is not None
    other.stdout.close()
