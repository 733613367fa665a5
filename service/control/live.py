"""A program under control while it runs: it goes on when it is told to, and may be changed.

Running state; no wall time. Units s at the inside, the user's units in the status.
"""

from dataclasses import dataclass
from math import inf, isfinite

from controller.orders import Criterion, CriterionTo, Event, EventKind, MotorPowerTo, SwitchTo
from service.control.disturbances import MOST_FACTOR
from service.control.live_run import Taken
from service.control.run import ControlRun, Session
from service.control.setup import hardness_against
from service.control.tape import CM3_MIN, Tape, known
from service.reading import one_of
from simulator.library import material_names
from simulator.physics.spindle import available_power
from simulator.plant.hidden import Change, Changed
from stepnc_model.errors import StepNcError
from stepnc_model.units import kw_from_watts, mm_min_from_speed

MOST_PERCENT = 100.0 * MOST_FACTOR


@dataclass(frozen=True, slots=True, kw_only=True)
class Changes:
    """What is to be otherwise; None: as it is.

    Raises
    ------
    StepNcError
        When a percentage is beyond its bounds, or the material unknown.
    """

    mode: str | None = None
    """TC or QC"""
    is_on: bool | None = None
    """whether the loop acts"""
    motor_power_percent: float | None = None
    """of the machine's motor that the operator allows"""
    depth_percent: float | None = None
    """of the depth that the program knows; the loop is not told"""
    hardness_percent: float | None = None
    """k_c against the workpiece's; the loop is not told"""
    material: str | None = None
    """another workpiece, by its name in the library; the loop is not told"""

    def __post_init__(self) -> None:
        for words, value in (
            ("motor power", self.motor_power_percent),
            ("depth", self.depth_percent),
            ("hardness", self.hardness_percent),
        ):
            if value is not None and not 0.0 < value <= MOST_PERCENT:
                bound = f"above 0 to {MOST_PERCENT:g} %"
                raise StepNcError(f"{words} {value:g} %: it must be {bound}")
        if self.material is not None and self.material not in material_names():
            known = ", ".join(material_names())
            raise StepNcError(f"unknown material '{self.material}'; known: {known}")


@dataclass(frozen=True, slots=True, kw_only=True)
class ControlStatus:
    """How a program under control is."""

    time: float
    """s"""
    progress: float
    """share of the program that is behind, 0 to 1"""
    workingstep: str
    """its id; empty: none"""
    feed_programmed_mm_min: float
    feed_advised_mm_min: float
    """that the loop commands"""
    feed_actual_mm_min: float
    override_percent: float
    """commanded"""
    force_measured: float | None
    """N, mean of the last revolution; None: there was none"""
    set_point: float | None
    """N; None: nothing bounds the force"""
    force_expected: float | None
    """N, with the catalogue's k_c; None: as the measured one"""
    power_kw: float
    """that the main drive really draws"""
    motor_power_kw: float | None
    """that the motor gives now, as far as the operator allows; None: the spindle stands"""
    removal_rate_cm3_min: float
    """that really is removed"""
    axial_depth_mm: float
    """that really is cut"""
    is_over: bool
    """power limit warning: the drive draws more than the motor has, or did a second ago"""
    holding: str
    """what holds the feed now"""
    level: str
    """of the force, as the loop sees it"""
    criterion: Criterion
    is_on: bool
    is_stopped: bool
    """the loop has stopped the program, or lost the machine"""
    is_done: bool
    """the program is through, or stopped"""


class LiveControl:
    """A program under control, piece by piece. Running state.

    Parameters
    ----------
    session : Session
        As :func:`service.control.run.prepare` makes it, before its first cycle.
    """

    def __init__(self, session: Session) -> None:
        self.session = session
        self._tape = Tape(self._motor_power)
        self._trace = session.trace(self._tape)
        self._cycles = session.cycles([self._trace])
        self._told = 0
        """events of the session that are on the tape"""
        self._hardness = self._material = 1.0
        """factors on k_c"""
        self._is_done = False

    @property
    def time(self) -> float:
        """S of the machine."""
        return self.session.machine.time

    def advance(self, until: float) -> bool:
        """Run until a time, s; False: the program is through, or stopped."""
        while not self._is_done and self.time < until:
            self._is_done = next(self._cycles, None) is None
        return not self._is_done

    def taken(self) -> Taken:
        """Rows and events since it was asked last."""
        events = self.session.events
        for event in events[self._told :]:
            self._tape.note(event)
        self._told = len(events)
        return self._tape.taken()

    def change(self, changes: Changes) -> None:
        """Let something be otherwise from the next cycle on.

        Raises
        ------
        StepNcError
            When the mode is unknown; nothing has changed then.
        """
        mode = None if changes.mode is None else one_of(Criterion, changes.mode.upper(), "mode")
        hardness = hardness_against(self.session.plan.material)
        material = None if changes.material is None else hardness(changes.material)
        loop = self.session.loop
        if mode is not None:
            loop.order(CriterionTo(criterion=mode))
        if changes.is_on is not None:
            loop.order(SwitchTo(is_on=changes.is_on))
        if changes.motor_power_percent is not None:
            loop.order(MotorPowerTo(factor=0.01 * changes.motor_power_percent))
        if changes.depth_percent is not None:
            self._hide(Changed.DEPTH, 0.01 * changes.depth_percent)
            self._say(f"depth {changes.depth_percent:g} % of the program's")
        if changes.hardness_percent is not None:
            self._hardness = 0.01 * changes.hardness_percent
            self._say(f"hardness {changes.hardness_percent:g} %")
        if material is not None:
            self._material = material
            self._say(f"workpiece {changes.material}: k_c {100.0 * material:.3g} %")
        if material is not None or changes.hardness_percent is not None:
            self._hide(Changed.HARDNESS, self._hardness * self._material)

    def status(self) -> ControlStatus:
        """How the run is now."""
        session, row = self.session, self._tape.last
        loop, machine, aims = session.loop, session.machine, session.loop.aims
        power = self._motor_power()
        programmed = 0.0 if row is None else row.feed_programmed
        return ControlStatus(
            time=machine.time,
            progress=machine.share,
            workingstep="" if row is None else row.workingstep,
            feed_programmed_mm_min=mm_min_from_speed(programmed),
            feed_advised_mm_min=mm_min_from_speed(loop.override * programmed),
            feed_actual_mm_min=0.0 if row is None else mm_min_from_speed(row.feed_actual),
            override_percent=100.0 * loop.override,
            force_measured=None if row is None else known(row.force_measured),
            set_point=None if row is None else known(row.set_point),
            force_expected=None if row is None else known(row.force_expected),
            power_kw=0.0 if row is None else kw_from_watts(row.spindle_power_true),
            motor_power_kw=kw_from_watts(power) if isfinite(power) else None,
            removal_rate_cm3_min=0.0 if row is None else CM3_MIN * row.removal_rate,
            axial_depth_mm=0.0 if row is None else row.axial_depth,
            is_over=not self._is_done and self._tape.is_over(machine.time),
            holding=session.holdings.words,
            level=session.holdings.level.value,
            criterion=aims.criterion,
            is_on=aims.is_on,
            is_stopped=loop.is_stopped or session.is_lost,
            is_done=self._is_done,
        )

    def finish(self) -> ControlRun:
        """Close what is written, and tell what was found, as ``control`` does; once.

        What was written of a run that is not done is left as partial.

        Raises
        ------
        WriteError
            When the disk refuses.
        """
        self._trace.close(is_whole=self._is_done)
        return self.session.result(self._trace)

    def _hide(self, what: Changed, factor: float) -> None:
        """Change the machine, and tell the loop nothing."""
        machine = self.session.machine
        machine.change(Change(time=machine.time, what=what, value=factor))

    def _say(self, text: str) -> None:
        event = Event(time=self.time, kind=EventKind.ORDER, text=text)
        self.session.events.append(event)
        self._trace.note(event)

    def _motor_power(self) -> float:
        """W that the motor gives now, as far as the operator allows; infinite: it stands."""
        session = self.session
        machine = session.machine
        speed = float(machine.course.spindle_speed[machine.truth.cell])
        if not speed > 0.0:
            return inf
        factor = session.loop.aims.power_factor
        return factor * available_power(session.virtual.spindle, speed)
