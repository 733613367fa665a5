"""A state of LinuxCNC in a cut, as its component sends it."""

from typing import Any

STATE: dict[str, Any] = {
    "time": 0.0, "position": [0.0, 0.0, 0.0], "speed": 10.0, "spindle": 50.0, "line": 1,
    "kind": 2, "adaptive": 1.0, "feed_override": 1.0, "load": None, "file": "part.ngc",
    "is_armed": True, "is_fresh": True, "is_tripped": False, "is_adaptive": True,
    "is_estop": False, "is_on": True, "is_running": True, "is_paused": False,
    "is_held": False, "is_hold_allowed": True, "refused": "",
}  # fmt: skip
