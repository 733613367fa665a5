"""A process whose starter was killed ends, whatever it does."""

import os
import select
import signal
import sys
from pathlib import Path
from subprocess import DEVNULL, PIPE, Popen, check_output

import pytest

from service.processes.lifeline import end_with_parent, starting
from tests.service.waiting import ended

STARTER = """
import multiprocessing, sys, time
from service.processes.lifeline import end_with_parent

def work(line):
    end_with_parent()
    line.send(True)
    while True:
        time.sleep(1.0)

if __name__ == "__main__":
    context = multiprocessing.get_context(sys.argv[1])
    ours, theirs = context.Pipe()
    child = context.Process(target=work, args=(theirs,))
    child.start()
    ours.recv()
    print(child.pid, flush=True)
    child.join()
"""


def test_the_child_of_a_killed_process_ends(tmp_path: Path) -> None:
    script = tmp_path / "starter.py"
    script.write_text(STARTER)
    starter = Popen([sys.executable, str(script), "spawn"], stdout=PIPE, stderr=DEVNULL)
    assert starter.stdout is not None
    child = os.pidfd_open(int(starter.stdout.readline()))
    starter.send_signal(signal.SIGKILL)
    ended(starter)
    starter.stdout.close()
    # A pidfd can be read from when its process has ended.
    with os.fdopen(child, "rb", buffering=0):
        assert select.select([child], [], [], 10.0)[0] == [child]


def test_a_process_without_a_starter_goes_on() -> None:
    end_with_parent()


DEAF = """
import multiprocessing, signal
from pathlib import Path
from service.processes.lifeline import starting

if __name__ == "__main__":
    child = multiprocessing.get_context("spawn").Process(target=signal.pause)
    with starting():
        child.start()
    print(Path(f"/proc/{child.pid}/status").read_text())
    child.kill()
"""


def test_a_child_is_deaf_to_ctrl_c_from_its_first_moment(tmp_path: Path) -> None:
    script = tmp_path / "deaf.py"
    script.write_text(DEAF)
    words = check_output([sys.executable, str(script)], text=True).split()
    blocked = int(words[words.index("SigBlk:") + 1], 16)
    assert blocked & 1 << (signal.SIGINT - 1)
    assert not blocked & 1 << (signal.SIGTERM - 1)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupt_waits_until_a_child_is_started(number: signal.Signals) -> None:
    came: list[int] = []
    before = signal.signal(number, lambda number, _: came.append(number))
    try:
        with starting():
            os.kill(os.getpid(), number)
            assert came == []
        assert came == [number]
    finally:
        signal.signal(number, before)
