"""HAL component ``stepnc`` under the system's Python: joins LinuxCNC to the loop by a socket.

``component.py SOCKET`` listens on a Unix socket. One loop at a time sends lines of JSON with
the override, and gets one with the state of the control every period. Whatever the loop sends,
the pin has a finite value from 0 to 1, and the safe value when the loop has been silent for
long.
It starts and ends no program, and is no emergency stop.

Nothing else of the project is imported: LinuxCNC's modules belong to the system's Python alone.
Units mm, s, rev/s.
"""

import json
import math
import os
import socket
import sys
import time
from contextlib import suppress
from pathlib import Path
from typing import Any

PERIOD = 0.005
"""Time between two messages, s."""

SILENCE = 0.5
"""Time after which the last set point of a silent loop no longer holds, s."""

DISARMED = 0.05
"""Time for which the watchdog is switched off before it is armed, s: several servo periods."""

LONGEST_LINE = 4096
"""Longest line of JSON that is taken, bytes."""

OUTPUTS = {"adaptive": "FLOAT", "virtual-load": "FLOAT", "hold": "BIT", "heartbeat": "BIT",
           "arm": "BIT", "reset": "BIT", "armed": "BIT"}  # fmt: skip
INPUTS = {"alive": "BIT", "tripped": "BIT"}


def set_point(wanted: object) -> float | None:
    """Override within 0 to 1; None if what was sent is no finite number."""
    if isinstance(wanted, bool) or not isinstance(wanted, int | float):
        return None
    return min(max(float(wanted), 0.0), 1.0) if math.isfinite(wanted) else None


class LoopLine:
    """Connection to the loop, if there is one; running state."""

    def __init__(self, path: str) -> None:
        Path(path).unlink(missing_ok=True)
        self._door = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self._door.bind(path)
        # Whoever may write to it moves the machine.
        os.chmod(path, 0o600)
        self._door.listen(1)
        self._door.setblocking(False)
        self._line: socket.socket | None = None
        self._rest = b""
        self.is_new = False
        """True until a connection that has just been made is armed."""

    @property
    def is_there(self) -> bool:
        """True while a loop is connected."""
        return self._line is not None

    def close(self) -> None:
        """Drop the loop, and listen no longer."""
        self._drop()
        self._door.close()

    def accept(self) -> None:
        """Take a loop that waits, unless there is one."""
        if self._line is not None:
            return
        with suppress(BlockingIOError):
            self._line, _ = self._door.accept()
            self._line.setblocking(False)
            self._rest, self.is_new = b"", True

    def last(self) -> dict[str, Any] | None:
        """Last whole line that has arrived; None if there is none."""
        found = None
        while self._line is not None:
            try:
                piece = self._line.recv(65536)
            except BlockingIOError:
                break
            except OSError:
                piece = b""
            if not piece:
                self._drop()
                break
            *lines, self._rest = (self._rest + piece).split(b"\n")
            if len(self._rest) > LONGEST_LINE:
                self._drop()
                break
            for line in lines:
                with suppress(ValueError):
                    told = json.loads(line)
                    found = told if isinstance(told, dict) else found
        return found

    def send(self, state: dict[str, Any]) -> None:
        """Send the state; a loop that does not read is dropped."""
        if self._line is None:
            return
        try:
            self._line.sendall(json.dumps(state).encode() + b"\n")
        except OSError:
            self._drop()

    def _drop(self) -> None:
        if self._line is not None:
            self._line.close()
        self._line, self._rest = None, b""


class Control:
    """State of LinuxCNC, from its pins and its task."""

    def __init__(self, hal: Any, linuxcnc: Any) -> None:
        self._hal, self._api = hal, linuxcnc
        self._stat = linuxcnc.stat()

    def state(self, load_pin: str) -> dict[str, Any]:
        """State of the control now; positions in the coordinates of the program."""
        pin, stat, api = self._hal.get_value, self._stat, self._api
        try:
            stat.poll()
            task = {
                "feed_override": stat.feedrate,
                "is_adaptive": bool(stat.adaptive_feed_enabled),
                "is_estop": bool(stat.estop),
                "is_on": stat.task_state == api.STATE_ON,
                "is_running": stat.interp_state != api.INTERP_IDLE,
                "is_paused": bool(stat.paused),
                "file": stat.file,
                "is_hold_allowed": bool(stat.feed_hold_enabled),
            }
            offsets = [
                sum(each) for each in zip(
                    stat.g5x_offset[:3], stat.g92_offset[:3], stat.tool_offset[:3], strict=True
                )
            ]  # fmt: skip
            mask, turn = stat.axis_mask, -math.radians(stat.rotation_xy)
        except api.error:
            # Before its first state the task has none.
            return {"is_running": False, "is_on": False}
        x, y, z = (
            float(pin(f"axis.{name}.pos-cmd")) - offset if mask & 1 << number else 0.0
            for number, (name, offset) in enumerate(zip("xyz", offsets, strict=True))
        )
        return {
            **task,
            "position": [x * math.cos(turn) - y * math.sin(turn),
                         x * math.sin(turn) + y * math.cos(turn), z],
            "speed": pin("motion.current-vel"),
            "spindle": pin("spindle.0.speed-in"),
            "line": pin("motion.program-line"),
            "kind": pin("motion.motion-type"),
            "adaptive": pin("motion.adaptive-feed"),
            "is_held": bool(pin("motion.feed-hold")),
            "load": float(pin(load_pin)) if load_pin else None,
        }  # fmt: skip


def _pins(hal: Any) -> Any:
    pins = hal.component("stepnc")
    for names, direction in ((OUTPUTS, hal.HAL_OUT), (INPUTS, hal.HAL_IN)):
        for name, kind in names.items():
            pins.newpin(name, getattr(hal, f"HAL_{kind}"), direction)
    pins.newparam("safe", hal.HAL_FLOAT, hal.HAL_RW)
    pins["safe"] = 0.2
    pins["adaptive"] = pins["safe"]
    pins.ready()
    return pins


def main() -> None:
    """Serve the socket that is named on the command line, until LinuxCNC ends."""
    sys.path.append("/usr/lib/python3/dist-packages")
    import hal  # noqa: PLC0415 (of the system's Python alone)
    import linuxcnc  # noqa: PLC0415

    # The socket exists before HAL waits no longer for this component.
    loop = LoopLine(sys.argv[1])
    pins = _pins(hal)
    # The task starts after the HAL files are read.
    control: Control | None = None
    begun = heard = armed = 0.0
    load_pin, refused, is_ready = "", "", False
    while True:
        now = time.monotonic()
        loop.accept()
        if loop.is_new:
            loop.is_new, begun, armed, heard = False, now, 0.0, now
            # A new loop begins disarmed, and releases the hold of the hard limit.
            pins["arm"], pins["reset"] = False, True
            load_pin, refused, is_ready = "", "", False
        told = loop.last()
        if told is not None:
            wanted = set_point(told.get("override"))
            # What is no number does not count as having been heard.
            heard = heard if wanted is None else now
            load_pin = str(told.get("load_pin", load_pin))
            is_ready = bool(told.get("is_ready", False))
            if wanted is not None:
                pins["adaptive"] = wanted
            pins["hold"] = bool(told.get("hold", False))
            if "virtual_load" in told:
                pins["virtual-load"] = float(told["virtual_load"])
        is_fresh = loop.is_there and now - heard <= SILENCE
        if not is_fresh:
            pins["adaptive"] = pins["safe"]
        if loop.is_there and now - begun >= DISARMED:
            pins["arm"], pins["reset"] = True, False
            armed = armed or now
        is_armed = bool(is_fresh and pins["arm"] and now - armed >= DISARMED and pins["alive"])
        pins["armed"] = is_armed and is_ready
        pins["heartbeat"] = not pins["heartbeat"]
        if loop.is_there:
            try:
                control = control or Control(hal, linuxcnc)
                state = control.state(load_pin)
            except (RuntimeError, linuxcnc.error) as error:
                state, refused = {}, str(error)
            loop.send({
                "time": now, "is_armed": is_armed, "is_tripped": bool(pins["tripped"]),
                "is_fresh": is_fresh, "refused": refused, **state,
            })  # fmt: skip
        time.sleep(PERIOD)


if __name__ == "__main__":
    main()
