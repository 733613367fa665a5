"""LinuxCNC as the machine of the closed loop, at places of the program's nominal course.

The control moves; its component says where, how fast and in which line. The place on the
course is the nearest one within the running line, because a path may come by again near itself.
The load is that of a pin, or that of our own process behind the real motion: the force of the
course at the actual feed, with hidden factors on hardness and depth. Units mm, s, N, W, rev/s.
"""

from bisect import bisect_right
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from math import inf, isfinite, nan, pi
from pathlib import Path

import numpy as np

from extras.linuxcnc.link import ControlState, Link
from simulator.errors import MachineSilent, SimulationError
from simulator.motion.segments import Ints
from simulator.plant.controlled_machine import TrueState
from simulator.plant.course import NominalCourse
from simulator.plant.hidden_behaviour import HiddenChange, HiddenQuantity, HiddenTruth
from simulator.reading import Reading
from stepnc_model.errors import StepNcError
from stepnc_model.units import NMM_S_PER_WATT

RAPID, FEED, ARC = 1, 2, 3
"""Kinds of motion of LinuxCNC."""

READING = 0.012
"""Shortest period of a reading, s: two or three messages of the component."""

SLOWEST = 0.1
"""Spindle speed below which the spindle counts as stopped, rev/s."""

LONGEST_START = 60.0
"""Time within which a program must begin once the loop is armed, s."""

STALE = 2.0
"""Time for which a load that is measured may stay exactly the same in a cut, s."""

SAME = 1e-4
"""Difference of the operator's override that counts as none."""

TINY = 1e-12
"""Squared length of a step between cells that counts as none, mm²."""

PROCESS = frozenset({HiddenQuantity.DEPTH, HiddenQuantity.HARDNESS})
"""Hidden changes that our own process behind the real motion can make."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Load:
    """Where the load comes from, and what it means."""

    pin: str = ""
    """HAL pin; empty: our own process."""
    watts: float = 1.0
    """Power of the drive at one unit of the pin, W; 0: the pin has newtons."""


class LinuxCncMachine:
    """LinuxCNC behind the ports of the loop; running state.

    Parameters
    ----------
    link : Link
    course : NominalCourse
        Course of the NC code that the control runs.
    hidden : HiddenTruth
        Of our own process; a load pin has none.
    load : Load
    efficiency : float
        Of the main drive.
    """

    def __init__(
        self,
        link: Link,
        course: NominalCourse,
        *,
        hidden: HiddenTruth,
        load: Load,
        efficiency: float,
    ) -> None:
        require_process(hidden, load)
        self.course, self.truth = course, TrueState()
        self.factors: dict[HiddenQuantity, float] = dict.fromkeys(PROCESS, 1.0)
        self.commanded = 1.0
        self.time = 0.0
        """Time since the program began, s."""
        self._link, self._load, self._efficiency = link, load, efficiency
        self._hidden = hidden
        self._changes = sorted(hidden.changes, key=lambda each: each.time)
        self._places = CoursePlaces(course)
        self._begun = nan
        self._progress, self._turned = 0.0, 0.0
        self._operator = nan
        self._is_held = self._has_ended = False
        self._same: tuple[float, float] = (nan, 0.0)

    @property
    def share(self) -> float:
        """Completed share of the program, 0 to 1."""
        return self._progress / self.course.duration

    def set(self, override: float, /) -> None:
        """Set the ratio of feed to programmed feed, at most 1; 0 holds the feed."""
        if not 0.0 <= override < inf:
            raise ValueError(f"override {override:g} must be at least 0 and finite")
        self.commanded = min(override, 1.0)
        # A component that is gone is noticed by the next reading.
        with suppress(MachineSilent):
            self._send()

    def close(self) -> None:
        """Hold the feed unless the program has ended: nobody watches the load any more."""
        if not self._has_ended:
            with suppress(MachineSilent):
                self._hold()
                self._link.state()

    def change(self, change: HiddenChange) -> None:
        """Apply a hidden change of our own process at its time."""
        self._changes = sorted((*self._changes, change), key=lambda each: each.time)

    def start(self) -> None:
        """Arm the component, and wait until the program runs.

        Raises
        ------
        SimulationError
            If the component cannot be armed, the operator's override is not 100 %, or no
            program begins.
        """
        begin: float | None = None
        while True:
            state = self._link.state()
            self._send(is_ready=state is not None and state.feed_override == 1.0)
            if state is None:
                continue
            begin = state.time if begin is None else begin
            waited = state.time - begin
            if abs(state.feed_override - 1.0) > SAME:
                text = f"the operator's feed override is {100.0 * state.feed_override:g} %"
                raise SimulationError(f"LinuxCNC: {text}, not 100 %: nothing was started")
            if state.is_estop or not state.is_on:
                raise SimulationError("LinuxCNC: the machine is off: nothing was started")
            if state.is_running and state.line:
                self._begun, self._operator = state.time, state.feed_override
                return
            if waited > 1.0 and not state.is_armed:
                text = "the watchdog of the loop is not armed (watchdog.ok-out)"
                raise SimulationError(f"LinuxCNC: {text}: nothing was started")
            if waited > LONGEST_START:
                text = f"no program began within {LONGEST_START:g} s"
                raise SimulationError(f"LinuxCNC: {text}")

    def read(self) -> Reading | None:
        """Wait for a reading; None when the program has ended.

        Raises
        ------
        MachineSilent
            If the component is gone, or what was agreed with the control no longer holds.
        """
        if not isfinite(self._begun):
            self.start()
        before = self.time
        while True:
            try:
                state = self._link.state()
            except MachineSilent as silent_:
                # In the time of the run, not of the component.
                raise MachineSilent(self.time) from silent_
            if state is None:
                raise self._lost("the task of the control has no state")
            self.time = state.time - self._begun
            if not state.is_running and not state.is_estop and state.is_on:
                self._has_ended = True
                return None
            self._require_agreed(state)
            reading = self._reading(state, self.time - before)
            self._send()
            if reading is not None:
                return reading

    def _require_agreed(self, state: ControlState) -> None:
        """Refuse to go on where the loop has no effect, or the control has stopped."""
        is_feed = state.kind in {FEED, ARC}
        override = 100.0 * state.feed_override
        refused = {
            "emergency stop": state.is_estop or not state.is_on,
            "the hard load limit holds the feed": state.is_tripped,
            "the watchdog of the loop has tripped": not state.is_armed and state.is_fresh,
            f"the operator's feed override is {override:g} %, not 100 %": (
                abs(state.feed_override - self._operator) > SAME
            ),
            "the program has no M52 P1 (post --adaptive-feed)": (
                is_feed and not state.is_adaptive
            ),
            "M53 P0 switches the feed hold off": is_feed and not state.is_hold_allowed,
        }
        for text, is_so in refused.items():
            if is_so:
                # What the loop cannot steer must not cut on.
                self._hold()
                raise self._lost(f"{text}; the feed is held")

    def _lost(self, text: str) -> MachineSilent:
        found = MachineSilent(self.time)
        found.args = (f"LinuxCNC at {self.time:.2f} s: {text}",)
        return found

    def _reading(self, state: ControlState, period: float) -> Reading | None:
        """Reading of a state; None before its period has passed."""
        course = self.course
        while self._changes and self._changes[0].time <= self.time:
            change = self._changes.pop(0)
            self.factors[change.what] = change.value
        progress, cell = self._places.nearest(state, self._progress)
        is_feed = bool(state.kind in {FEED, ARC} and course.can_override[cell])
        nominal = float(course.feed[cell])
        override = state.speed / nominal if is_feed and nominal > 0.0 else 1.0
        load = self._measured(state, cell, override if is_feed else 0.0)
        if period < READING:
            return None
        self._progress = progress
        teeth, speed = int(course.teeth[cell]), float(course.spindle_speed[cell])
        tooth = int(self._turned) % teeth
        self._turned += period * teeth * speed
        force, power = self._shown(load, cell)
        return Reading(
            time=self.time,
            period=period,
            force=np.array([force]),
            power=power,
            feed=state.speed,
            override=override,
            spindle_speed=speed,
            teeth=teeth,
            tooth=tooth,
            progress=progress,
            workingstep=int(course.workingstep[cell]),
            can_override=is_feed,
        )

    def _measured(self, state: ControlState, cell: int, override: float) -> float:
        """Load, N of our own process or the units of the pin; NaN when it is stale."""
        if self._load.pin:
            value = nan if state.load is None else state.load
            last, since = self._same
            if value != last:
                self._same = (value, state.time)
            elif self._is_cut(cell, override) and state.time - since > STALE:
                return nan
            return value
        course = self.course
        shape = float(np.power(max(override, 0.0), course.exponent[cell]))
        force = float(course.force[cell]) * shape * self._hidden.force_factor
        force *= self.factors[HiddenQuantity.HARDNESS] * self.factors[HiddenQuantity.DEPTH]
        depth = self.factors[HiddenQuantity.DEPTH]
        around = pi * float(course.diameter[cell]) * float(course.spindle_speed[cell])
        idle = float(course.idle_power[cell])
        self.truth = TrueState(
            force=force,
            peak=force,
            power=idle + force * around / NMM_S_PER_WATT / self._efficiency,
            removal_rate=override * depth * float(course.removal_rate[cell]),
            axial_depth=depth * float(course.axial_depth[cell]),
            cell=cell,
        )
        return force

    def _is_cut(self, cell: int, override: float) -> bool:
        """True where chips are expected: a load in air may well stay the same."""
        return override > 0.0 and bool(self.course.force[cell] > 0.0)

    def _shown(self, load: float, cell: int) -> tuple[float, float]:
        """Force and power of a load, N and W."""
        if not self._load.pin:
            return load, self.truth.power
        if self._load.watts == 0.0:
            self.truth = TrueState(force=load, peak=load, cell=cell)
            return load, nan
        power = self._load.watts * load
        self.truth = TrueState(power=power, cell=cell)
        return nan, power

    def _hold(self) -> None:
        """Hold the feed for good: a new connection alone releases it."""
        self._is_held = True
        self._send()

    def _send(self, *, is_ready: bool = True) -> None:
        """Send the set point, and the load of our own process."""
        words: dict[str, object] = {
            "override": self.commanded,
            "hold": self._is_held,
            "is_ready": is_ready,
        }
        if self._load.pin:
            words["load_pin"] = self._load.pin
        else:
            words["virtual_load"] = self.truth.force
        self._link.send(words)


class CoursePlaces:
    """Search of the place on a course, within the line that runs."""

    def __init__(self, course: NominalCourse) -> None:
        self._path = np.asarray(course.position, dtype=np.float64)
        self._until = np.concatenate(([0.0], course.until))
        self._rows = _rows_of(course.line)
        self._ends: list[float] = course.until.tolist()

    def nearest(self, state: ControlState, progress: float) -> tuple[float, int]:
        """Program time, s, and cell that are nearest to a position; it never goes back."""
        here = min(bisect_right(self._ends, progress), len(self._ends) - 1)
        first, last = self._rows.get(state.line, (here, here))
        if last < here:
            return progress, here
        first = max(first, here)
        path = self._path[first : last + 1]
        distance = np.linalg.norm(path - state.position, axis=1)
        near = int(distance.argmin())
        cell = first + near
        # Within the cell by the projection on the way between the middles beside it.
        low, high = max(near - 1, 0), min(near + 1, len(path) - 1)
        way = path[high] - path[low]
        square = float(way @ way)
        middle = 0.5 * (self._until[cell] + self._until[cell + 1])
        if square > TINY:
            part = float((np.asarray(state.position) - path[near]) @ way) / square
            span = self._until[first + high + 1] - self._until[first + low + 1]
            middle += part * span
        found = max(progress, min(middle, self._until[first + len(path)]))
        return found, min(bisect_right(self._ends, found), len(self._ends) - 1)


def _rows_of(lines: Ints) -> Mapping[int, tuple[int, int]]:
    """First and last cell of each line that runs once."""
    found: dict[int, tuple[int, int]] = {}
    for cell, line in enumerate(lines.tolist()):
        first, _ = found.get(line, (cell, cell))
        found[line] = (first, cell)
    return found


def require_process(hidden: HiddenTruth, load: Load) -> None:
    """Refuse hidden behaviour that the process behind the real motion has not.

    Raises
    ------
    StepNcError
        With the first that is not possible.
    """
    usual = HiddenTruth()
    other = [each.what.value for each in hidden.changes if each.what not in PROCESS]
    other += [
        name
        for name in ("wear_rate", "flank_wear", "eccentricity", "servo_lag")
        if getattr(hidden, name) != getattr(usual, name)
    ]
    if load.pin and (hidden.changes or hidden.force_factor != 1.0 or other):
        raise StepNcError("--disturb: a measured load is not disturbed: use --virtual-load")
    if other:
        text = "behind LinuxCNC's motion only kc, hardness, material and depth change"
        raise StepNcError(f"--disturb {other[0].replace('_', ' ')}: {text}")


def require_adaptive(code: Path) -> None:
    """Refuse code without M52 P1, which the loop could not steer.

    Raises
    ------
    StepNcError
        If the code does not switch adaptive feed on.
    """
    words = code.read_text("ascii", "replace").upper().replace(" ", "")
    if "M52P1" not in words:
        raise StepNcError(
            f"{code}: no M52 P1, without which LinuxCNC ignores the loop: "
            "write the code with post --adaptive-feed"
        )
