"""Connection of ``control`` to LinuxCNC, as its options say."""

from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path

from extras.linuxcnc.bench import bench_with_loop, reason_why_not
from extras.linuxcnc.drive import (
    LinuxCncMachine,
    Load,
    require_adaptive,
    require_process,
)
from extras.linuxcnc.link import Link
from service.progress import Tell
from service.requests.runs import ControlRequest, SensorChoice
from service.simulation.drive import Drive, LoopMachine
from service.verbs.control.request import ControlFiles, LoadUnit
from simulator.motion.model_name import ControlModelName
from simulator.plant.course import NominalCourse
from simulator.plant.hidden_behaviour import HiddenTruth
from simulator.spec import Machine
from stepnc_model.errors import StepNcError

BENCH = "bench"
"""Word for a LinuxCNC that is started for the run."""

FULL = 100.0
"""Greatest override of LinuxCNC's pin, %."""

REALTIME_MARGIN = 2.0
"""Hard limit of the bench over the greatest force of the program."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DrivenRun:
    """Drive of a run, and its request as LinuxCNC can obey it."""

    drive: Drive
    request: ControlRequest


def drive_of(
    files: ControlFiles, request: ControlRequest, stack: ExitStack, tell: Tell
) -> DrivenRun:
    """Return the drive of a run; what it opens is closed with the stack.

    Raises
    ------
    StepNcError
        When options contradict each other, or LinuxCNC cannot run here.
    """
    code = files.code
    if code is None or files.file is None or code == files.file:
        text = "name the program and the NC code that runs: PART --nc CODE"
        raise StepNcError(f"--linuxcnc: {text}")
    require_adaptive(code)
    is_bench = files.linuxcnc == BENCH
    if is_bench and files.load_pin:
        raise StepNcError("--load-pin: the bench has none; it takes the load from the model")
    if not is_bench and files.virtual_load == bool(files.load_pin):
        raise StepNcError("--linuxcnc SOCKET needs --load-pin, or --virtual-load: one of them")
    if is_bench and (reason := reason_why_not()):
        raise StepNcError(f"--linuxcnc bench: {reason}")

    def connect(course: NominalCourse, hidden: HiddenTruth, machine: Machine) -> LoopMachine:
        load = _load(files, machine)
        require_process(hidden, load)
        place = Path(files.linuxcnc)
        if is_bench:
            limit = files.load_limit or REALTIME_MARGIN * float(course.force.max())
            x, y, z = map(float, course.position[0])
            bench = bench_with_loop(
                machine,
                code,
                start=(x, y, z),
                load_limit=limit,
                patience=60.0 + 5.0 * course.duration,
            )
            place = stack.enter_context(bench).socket
            tell(f"LinuxCNC: started; realtime holds the feed above {limit:.0f} N")
        link = stack.enter_context(Link(place))
        driven = LinuxCncMachine(
            link, course, hidden=hidden, load=load, efficiency=machine.spindle.efficiency
        )
        stack.callback(driven.close)
        tell(
            "LinuxCNC: connected; start the program" if not is_bench else "LinuxCNC: connected"
        )
        return driven

    name = "LinuxCNC" if files.load_pin else "LinuxCNC with a virtual load"
    return DrivenRun(drive=Drive(name=name, connect=connect), request=_obeyed(files, request))


def _obeyed(files: ControlFiles, request: ControlRequest) -> ControlRequest:
    """Request with the motion model, the greatest override and the sensor of LinuxCNC."""
    high = request.override_high_percent
    if files.band and high > FULL:
        raise StepNcError(
            f"--band: LinuxCNC's adaptive feed takes {FULL:g} % at most, not {high:g} %: post "
            "the program at its highest feed"
        )
    sensor = request.sensor
    if files.load_pin:
        is_force = files.load_unit is LoadUnit.NEWTON
        sensor = SensorChoice.DYNAMOMETER if is_force else SensorChoice.POWER
    elif sensor is SensorChoice.COMPONENTS:
        raise StepNcError("--sensor components: the virtual load has no normal force")
    return replace(
        request,
        control=ControlModelName.LINUXCNC,
        override_high_percent=min(high, FULL),
        sensor=sensor,
    )


def _load(files: ControlFiles, machine: Machine) -> Load:
    """Load of a pin, in watts for one unit."""
    if not files.load_pin:
        return Load()
    if files.load_unit is LoadUnit.NEWTON:
        return Load(pin=files.load_pin, watts=0.0)
    if files.load_unit is LoadUnit.WATT:
        return Load(pin=files.load_pin)
    rated = files.rated or (FULL if files.load_unit is LoadUnit.PERCENT else 0.0)
    if not rated:
        raise StepNcError("--load-unit A needs --rated: the current at the rated power")
    power = max(point.power for point in machine.spindle.curve)
    return Load(pin=files.load_pin, watts=power / rated)
