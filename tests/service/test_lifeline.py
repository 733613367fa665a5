"""A process whose starter was killed ends, whatever it does."""

import os
import select
import signal
import sys
from pathlib import Path
from subprocess import DEVNULL, PIPE, Popen

from service.lifeline import end_with_parent
from tests.service.waiting import ended

STARTER = """
import multiprocessing, sys, time
from service.lifeline import end_with_parent

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
