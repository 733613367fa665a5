"""LinuxCNC's configuration for a machine of the library: its INI and HAL files and tool table.

Drives follow their commands perfectly. The spindle speeds up as the machine's does, tells when
it is at speed and turns an encoder, so that G95, G96 and G33 work. Tools change in no time and
have no length: positions in the log are those of the program. Axes may travel farther than the
machine's, because where the program zero lies is not known here.

LinuxCNC knows one greatest speed for each axis, here its rapid, and no jerk.
"""

from collections.abc import Iterable
from math import inf
from pathlib import Path

from simulator.planner_settings import PlannerSettings
from simulator.spec import Axis, Machine

TRAVEL = 10_000.0
"""Travel of each axis to either side of the program zero, mm."""

SAMPLES = 30_000
"""Rows that are kept until they are read: 30 s of motion."""

IMMEDIATE = 1e6
"""Acceleration of a spindle without one, rev/s²."""

SOCKET = "loop.socket"
"""Name of the socket at which the component of the loop listens."""

SAFE = 0.2
"""Feed without a loop, as a share of the programmed feed."""

LIMITS = "stepnc-range,stepnc-limit"
"""Comparators of the loop that belong to the same module as the spindle's."""

TIMEOUT = 5.0
"""Time without a heartbeat after which the safe feed holds, s of the servo thread.

Without a realtime kernel the thread stalls and then runs its periods in a burst, in which no
heartbeat comes: 0.1 to 0.2 s are for machines.
"""


def write_configuration(
    folder: Path, machine: Machine, settings: PlannerSettings, *, tools: Iterable[int]
) -> None:
    """Write ``machine.ini``, ``machine.hal`` and ``tool.tbl`` into a folder."""
    axes = sorted(machine.axes, key=lambda axis: axis.name)
    (folder / "machine.ini").write_text(_ini(axes, settings), "ascii")
    (folder / "machine.hal").write_text(_hal(machine, axes), "ascii")
    rows = "".join(f"T{number} P{number} Z0 D0\n" for number in sorted(set(tools)))
    (folder / "tool.tbl").write_text(rows, "ascii")


def write_loop(folder: Path, *, load_limit: float) -> None:
    """Add the realtime side of the closed loop, ``loop.hal``, and its section of the INI file.

    Parameters
    ----------
    folder : Path
        With the files of :func:`write_configuration`.
    load_limit : float
        Load above which realtime holds the feed, in the unit of the load.
    """
    here = Path(__file__).parent
    text = (here / "loop.hal").read_text("ascii")
    text = text.replace(f"loadrt near names={LIMITS}\n", "")
    # In the bench the load is what the loop's own process says.
    text += "net stepnc-load stepnc.virtual-load => stepnc-limit.in1\n"
    (folder / "loop.hal").write_text(text, "ascii")
    keys = {
        "COMPONENT": here / "component.py",
        "SOCKET": folder / SOCKET,
        "SAFE": SAFE,
        "LOAD_LIMIT": f"{load_limit:g}",
        "TIMEOUT": TIMEOUT,
    }
    with (folder / "machine.ini").open("a", encoding="ascii") as ini:
        ini.write("[STEPNC]\n" + "".join(f"{key} = {value}\n" for key, value in keys.items()))


def _ini(axes: list[Axis], settings: PlannerSettings) -> str:
    names = " ".join(axis.name for axis in axes)
    fastest = max(axis.rapid for axis in axes)
    # Several axes together accelerate more than one: the path must not be limited as well.
    along = 2.0 * max(axis.acceleration for axis in axes)
    sections: dict[str, dict[str, object]] = {
        "EMC": {"VERSION": 1.1, "MACHINE": "stepnc"},
        "DISPLAY": {"DISPLAY": "none", "MAX_FEED_OVERRIDE": settings.max_feed_override},
        "RS274NGC": {"PARAMETER_FILE": "variables"},
        # A second is too short on a busy host: the program ends early, without a message.
        "EMCMOT": {
            "EMCMOT": "motmod",
            "COMM_TIMEOUT": 30.0,
            "SERVO_PERIOD": round(1e9 * settings.servo_period),
        },
        "TASK": {"TASK": "milltask", "CYCLE_TIME": 0.001},
        "HAL": {"HALFILE": "machine.hal"},
        "TRAJ": {
            "COORDINATES": names,
            "LINEAR_UNITS": "mm",
            "ANGULAR_UNITS": "degree",
            "DEFAULT_LINEAR_VELOCITY": fastest,
            "MAX_LINEAR_VELOCITY": 2.0 * fastest,
            "DEFAULT_LINEAR_ACCELERATION": along,
            "MAX_LINEAR_ACCELERATION": along,
            "NO_FORCE_HOMING": 1,
        },
        "KINS": {
            "KINEMATICS": f"trivkins coordinates={names.replace(' ', '')}",
            "JOINTS": len(axes),
        },
        "EMCIO": {
            "EMCIO": "io",
            "CYCLE_TIME": 0.01,
            "TOOL_TABLE": "tool.tbl",
            "TOOL_CHANGE_WITH_SPINDLE_ON": 0,
        },
    }
    for number, axis in enumerate(axes):
        limits = {
            "MIN_LIMIT": -TRAVEL,
            "MAX_LIMIT": TRAVEL,
            "MAX_VELOCITY": axis.rapid,
            "MAX_ACCELERATION": axis.acceleration,
        }
        sections[f"AXIS_{axis.name}"] = dict(limits)
        sections[f"JOINT_{number}"] = {
            "TYPE": "LINEAR",
            **limits,
            "HOME": 0,
            "HOME_OFFSET": 0,
            "HOME_SEARCH_VEL": 0,
            "HOME_LATCH_VEL": 0,
            "HOME_SEQUENCE": 0,
            "FERROR": 100,
            "MIN_FERROR": 100,
        }
    return (
        "\n".join(
            "\n".join((f"[{section}]", *(f"{key} = {value}" for key, value in keys.items())))
            for section, keys in sections.items()
        )
        + "\n"
    )


def _hal(machine: Machine, axes: list[Axis]) -> str:
    columns = {axis.name: f"sampler.0.pin.{'XYZ'.index(axis.name)}" for axis in axes}
    lines = [
        "loadrt [KINS]KINEMATICS",
        "loadrt [EMCMOT]EMCMOT servo_period_nsec=[EMCMOT]SERVO_PERIOD "
        "num_joints=[KINS]JOINTS num_spindles=1",
        "loadrt limit2 names=run-up",
        # A module is loaded once, for all of its names.
        f"loadrt near names=at-speed,{LIMITS}",
        "loadrt sim_spindle names=encoder",
        f"loadrt sampler depth={SAMPLES} cfg=fffffss",
        "addf motion-command-handler servo-thread",
        "addf motion-controller servo-thread",
        "addf run-up servo-thread",
        "addf at-speed servo-thread",
        "addf encoder servo-thread",
        "addf sampler.0 servo-thread",
        "setp sampler.0.enable 0",
        *(
            f"net {axis.name.lower()}-place joint.{number}.motor-pos-cmd "
            f"=> joint.{number}.motor-pos-fb {columns[axis.name]}"
            for number, axis in enumerate(axes)
        ),
        "net spindle-speed run-up.out => at-speed.in2 encoder.velocity-cmd spindle.0.speed-in "
        "sampler.0.pin.3",
        "net path-speed motion.current-vel => sampler.0.pin.4",
        "net line motion.program-line => sampler.0.pin.5",
        "net kind motion.motion-type => sampler.0.pin.6",
        f"setp run-up.maxv {min(machine.spindle.acceleration or inf, IMMEDIATE):g}",
        "setp at-speed.difference 0.05",
        "net spindle-command spindle.0.speed-out-rps => run-up.in at-speed.in1",
        "net is-at-speed at-speed.out => spindle.0.at-speed",
        "net turns encoder.position-fb => spindle.0.revs",
        "net index spindle.0.index-enable <=> encoder.index-enable",
        "net enabled iocontrol.0.user-enable-out => iocontrol.0.emc-enable-in",
        "net prepared iocontrol.0.tool-prepare => iocontrol.0.tool-prepared",
        "net changed iocontrol.0.tool-change => iocontrol.0.tool-changed",
    ]  # fmt: skip
    return "\n".join(lines) + "\n"
