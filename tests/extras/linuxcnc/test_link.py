"""The loop's side of the connection to LinuxCNC's component."""

import json
import socket
from collections.abc import Iterator
from pathlib import Path

import pytest

from extras.linuxcnc.link import Link
from simulator.errors import MachineSilent, SimulationError
from tests.service.verbs.control.states import STATE

Served = tuple[Link, socket.socket]


@pytest.fixture
def served(tmp_path: Path) -> Iterator[Served]:
    with socket.socket(socket.AF_UNIX) as door:
        door.bind(str(tmp_path / "s"))
        door.listen()
        with Link(tmp_path / "s") as link, door.accept()[0] as line:
            yield link, line


def sent(line: socket.socket, /, **changes: object) -> None:
    line.sendall(json.dumps({**STATE, **changes}).encode() + b"\n")


def test_the_latest_state_counts(served: Served) -> None:
    link, line = served
    sent(line, line=3)
    sent(line, line=4, spindle=-10.0)
    state = link.state()
    assert state is not None
    assert (state.line, state.spindle) == (4, 10.0)


def test_a_task_without_a_state_has_none(served: Served) -> None:
    link, line = served
    line.sendall(b'{"time": 1.0, "refused": "", "is_armed": false}\n')
    assert link.state() is None


def test_a_component_that_is_gone_is_silent(served: Served) -> None:
    link, line = served
    sent(line, time=7.5)
    link.state()
    line.close()
    with pytest.raises(MachineSilent, match=r"since 7\.50 s"):
        link.state()


def test_no_component_is_refused(tmp_path: Path) -> None:
    with pytest.raises(SimulationError, match="no component of LinuxCNC listens"):
        Link(tmp_path / "none")
