"""The HAL component: what it lets through to the pin of adaptive feed."""

import math
import socket
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest

from extras.linuxcnc.component import LoopLine, set_point


@pytest.mark.parametrize(
    ("wanted", "found"), [(0.4, 0.4), (0, 0.0), (1.7, 1.0), (-0.5, 0.0), (1e300, 1.0)]
)
def test_a_set_point_is_kept_from_0_to_1(wanted: float, found: float) -> None:
    assert set_point(wanted) == found


@pytest.mark.parametrize("wanted", [math.nan, math.inf, -math.inf, None, "1", True, [1.0]])
def test_what_is_no_number_is_no_set_point(wanted: object) -> None:
    # NaN on the pin runs LinuxCNC at its greatest override, and a negative value backwards.
    assert set_point(wanted) is None


Connected = tuple[LoopLine, socket.socket]


@pytest.fixture
def connected(tmp_path: Path) -> Iterator[Connected]:
    loop = LoopLine(str(tmp_path / "s"))
    with closing(loop), socket.socket(socket.AF_UNIX) as line:
        line.connect(str(tmp_path / "s"))
        loop.accept()
        yield loop, line


def test_the_last_whole_line_counts(connected: Connected) -> None:
    loop, line = connected
    assert loop.is_new
    line.sendall(b'{"override": 0.5}\n{"override": 0.4}\nnonsense\n[1]\n{"over')
    assert loop.last() == {"override": 0.4}
    line.sendall(b'ride": 0.3}\n')
    assert loop.last() == {"override": 0.3}
    assert loop.last() is None


def test_a_loop_that_leaves_is_seen_after_its_last_line(connected: Connected) -> None:
    loop, line = connected
    line.sendall(b'{"hold": true}\n')
    line.close()
    assert loop.last() == {"hold": True}
    assert not loop.is_there


def test_an_endless_line_drops_the_loop(connected: Connected) -> None:
    loop, line = connected
    line.sendall(b"x" * 5000)
    assert loop.last() is None
    assert not loop.is_there


@pytest.mark.usefixtures("connected")
def test_only_its_user_may_write_to_the_socket(tmp_path: Path) -> None:
    assert (tmp_path / "s").stat().st_mode & 0o777 == 0o600
