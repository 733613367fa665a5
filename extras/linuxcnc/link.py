"""Connection to the component ``stepnc`` of a running LinuxCNC, at the side of the loop.

Units mm, s, rev/s.
"""

import json
import socket
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from simulator.errors import MachineSilent, SimulationError

PATIENCE = 1.0
"""Time for which the component may be silent, s."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ControlState:
    """State of LinuxCNC at one moment."""

    time: float
    """Clock of the component, s."""
    position: tuple[float, float, float]
    """Commanded position in the program's coordinates, mm; on a lathe X is a radius."""
    speed: float
    """Speed along the path, mm/s."""
    spindle: float
    """Magnitude of the spindle speed, rev/s."""
    line: int
    """Line of the program that moves, counted from 1; 0 if none."""
    kind: int
    """Kind of motion: 0 none, 1 rapid, 2 feed, 3 arc, 4 tool change."""
    adaptive: float
    """Value of the pin of adaptive feed."""
    feed_override: float
    """Operator's feed override, as a share."""
    load: float | None
    """Value of the load pin; None if none is read."""
    file: str
    is_armed: bool
    is_fresh: bool
    """True if the component has heard of the loop lately."""
    is_tripped: bool
    """True if the hard load limit has held the feed."""
    is_adaptive: bool
    """True if the program has switched adaptive feed on (M52 P1)."""
    is_estop: bool
    is_on: bool
    is_running: bool
    is_paused: bool
    is_held: bool
    """True if the pin of feed hold is set."""
    is_hold_allowed: bool
    """False after M53 P0, which ignores the pin of feed hold."""


class Link:
    """Lines of JSON to and from the component; running state.

    Parameters
    ----------
    path : Path
        Unix socket of the component.

    Raises
    ------
    SimulationError
        If nothing listens there.
    """

    def __init__(self, path: Path) -> None:
        self._line = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self._line.settimeout(PATIENCE)
        self._rest = b""
        self._time = 0.0
        try:
            self._line.connect(str(path))
        except OSError as error:
            self._line.close()
            text = f"{path}: no component of LinuxCNC listens there: {error.strerror or error}"
            raise SimulationError(text) from error

    def __enter__(self) -> "Link":
        return self

    def __exit__(self, *_: object) -> None:
        self._line.close()

    def send(self, words: Mapping[str, Any]) -> None:
        """Send one line.

        Raises
        ------
        MachineSilent
            If the component is gone.
        """
        try:
            self._line.sendall(json.dumps(words).encode() + b"\n")
        except OSError as error:
            raise MachineSilent(self._time) from error

    def state(self) -> ControlState | None:
        """Wait for the next state, the last of those that have arrived; None before the task.

        Raises
        ------
        MachineSilent
            If the component is silent or gone.
        """
        while b"\n" not in self._rest:
            try:
                piece = self._line.recv(65536)
            except OSError as error:
                raise MachineSilent(self._time) from error
            if not piece:
                raise MachineSilent(self._time)
            self._rest += piece
        *lines, self._rest = self._rest.split(b"\n")
        found = json.loads(lines[-1])
        self._time = found["time"]
        found.pop("refused")
        if "position" not in found:
            return None
        found["position"] = tuple(found["position"])
        found["spindle"] = abs(found["spindle"])
        return ControlState(**found)
