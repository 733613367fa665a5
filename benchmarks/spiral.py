"""Cycle time of a spiral on machines that hide their numbers, as paper 004 finds it.

Block time, acceleration, jerk and deviation of a machine are drawn, and its control is junction
or fir. It runs the test program and a spiral of short lines at several feeds; our agent
publishes the runs at 100 Hz with a twentieth of the samples missing, and our client logs them.
What predicts has the library's machine and control, and the block time that ``blockfit`` found
in the log. A control that stops at each block is shown for one machine, without a target.

References
----------
.. [1] A. Vijayaraghavan et al., "Addressing process planning and verification issues with
   MTConnect", 2009, Figs. 5 to 9: a 3D spiral, predictions "within 1 %".
"""

import argparse
import asyncio
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from math import cos, sin
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import uvicorn

import stepnc
from extras.agent.model.http import application
from extras.agent.play import begun, play
from extras.agent.requests import AgentRequest
from extras.agent.run import PublishedRun, listening, published_run
from service.simulation.code_simulation import CodeRequest
from service.simulation.run import RunFiles
from simulator.errors import CalibrationError
from simulator.files.machine_file import machine_toml
from simulator.library import load_machine
from simulator.motion.model_name import ControlModelName
from simulator.spec import Machine
from stepnc_model.units import mm_from_inches

LIBRARY = "vmc15"
SEEDS = 20
RATE = 100.0
"""Samples a second."""
MISSING = 0.05
"""Share of samples without values."""
FEEDS_IN_MIN = (50.0, 100.0, 200.0)
"""Feeds of the spiral; 100 in/min is that of the paper's Fig. 7."""
BLOCK_TIMES = (0.001, 0.008)
ACCELERATIONS = (1_000.0, 8_000.0)
JERKS = (20_000.0, 200_000.0)
DEVIATIONS = (0.005, 0.05)
"""Bounds of what is drawn, evenly in logarithms: s, mm/s², mm/s³, mm."""

LINES = 6_000
"""Lines of the spiral."""
RADII = (5.0, 30.0)
"""Radii of its end and its start, mm."""
STEP = 0.0117
"""Angle of a line, rad: spacings of 0.35 to 0.06 mm."""
DEPTH = 10.0
"""mm"""


@dataclass(frozen=True, slots=True, kw_only=True)
class HiddenMachine:
    """Machine whose numbers the prediction does not see."""

    machine: Machine
    control: ControlModelName
    deviation: float
    """Junction deviation, mm."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SpiralResult:
    """One spiral at one feed, s."""

    feed_in_min: float
    theoretical: float
    predicted: float
    actual: float

    @property
    def error(self) -> float:
        """Relative error of the prediction."""
        return self.predicted / self.actual - 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class MachineResult:
    """Results on one machine."""

    hidden: HiddenMachine
    block_time: float
    """Found by ``blockfit``, s."""
    spirals: tuple[SpiralResult, ...]


def drawn(seed: int, control: ControlModelName) -> HiddenMachine:
    """Machine with numbers drawn from a seed."""
    draw = np.random.default_rng(seed)

    def within(bounds: tuple[float, float]) -> float:
        return float(np.exp(draw.uniform(*np.log(bounds))))

    acceleration, jerk = within(ACCELERATIONS), within(JERKS)
    known = load_machine(LIBRARY)
    axes = tuple(replace(axis, acceleration=acceleration, jerk=jerk) for axis in known.axes)
    machine = replace(known, axes=axes, block_time=within(BLOCK_TIMES), block_time_source="")
    return HiddenMachine(machine=machine, control=control, deviation=within(DEVIATIONS))


def spiral_code(feed_in_min: float) -> str:
    """NC code of the spiral: its spacing falls smoothly with its radius."""
    lines = ["%", "G17 G21 G90 G94"]
    feed = mm_from_inches(feed_in_min)
    for row in range(LINES + 1):
        share = row / LINES
        radius = RADII[1] + share * (RADII[0] - RADII[1])
        x, y = radius * cos(STEP * row), radius * sin(STEP * row)
        head, rate = ("G1", f" F{feed:.3f}") if row == 1 else ("", "")
        lines.append(f"{head if row else 'G0'} X{x:.4f} Y{y:.4f} Z{-DEPTH * share:.4f}{rate}")
    return "\n".join([*lines, "M2", "%", ""])


def found_on(hidden: HiddenMachine, folder: Path) -> MachineResult:
    """Log test and spirals on a hidden machine, fit its block time, and predict.

    Raises
    ------
    CalibrationError
        When no block time explains the feeds of the test.
    """
    real = folder / "hidden.toml"
    real.write_text(machine_toml(hidden.machine), encoding="utf-8")
    test, found = folder / "test.ngc", folder / "found.toml"
    # A shortened test of the paper: a radius has no effect.
    stepnc.blocktest(
        output=test, machine=LIBRARY, spacing=(0.001, 0.0025, 0.005, 0.0075, 0.01), radius=1.0,
        lines=600,
    )  # fmt: skip
    with _served(_run(hidden, real, test)) as url:
        fit = stepnc.blockfit(url, program=test, machine=LIBRARY, output=found).fit
    spirals = []
    for feed in FEEDS_IN_MIN:
        code = folder / "spiral.ngc"
        code.write_text(spiral_code(feed), encoding="utf-8")
        with _served(_run(hidden, real, code)) as url:
            total = stepnc.cycletime(code, url, machine=found).total
        spirals.append(
            SpiralResult(
                feed_in_min=feed,
                theoretical=total.programmed,
                predicted=total.predicted,
                actual=total.actual or float("nan"),
            )
        )
    return MachineResult(hidden=hidden, block_time=fit.block_time.value, spirals=tuple(spirals))


def _run(hidden: HiddenMachine, machine: Path, code: Path) -> PublishedRun:
    """Run of NC code on a machine, ready to be published."""
    request = AgentRequest(
        machine=str(machine),
        control=hidden.control,
        deviation_mm=hidden.deviation,
        rate_hz=RATE,
        missing=MISSING,
        speed=0.0,
    )
    return published_run(request, RunFiles(code=CodeRequest(code=code)))


@contextmanager
def _served(run: PublishedRun) -> Iterator[str]:
    """Address of our agent, which has published the whole run."""
    listener = listening("127.0.0.1", 0)
    server: list[uvicorn.Server] = []
    is_ready = threading.Event()

    async def work() -> None:
        agent = begun(run, speed=0.0, size=1 << 20)
        config = uvicorn.Config(
            application(agent), log_config=None, lifespan="off", timeout_graceful_shutdown=1
        )
        server.append(uvicorn.Server(config))
        await play(agent, run, speed=0.0, is_looped=False)
        is_ready.set()
        await server[0].serve(sockets=[listener])

    thread = threading.Thread(target=asyncio.run, args=(work(),))
    thread.start()
    is_ready.wait(60.0)
    host, port = listener.getsockname()
    try:
        yield f"http://{host}:{port}"
    finally:
        server[0].should_exit = True
        thread.join(30.0)


def main(arguments: list[str] | None = None) -> None:
    """Print a row for each machine and spiral."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=SEEDS)
    options = parser.parse_args(arguments)
    print("control   seed  block ms: hidden   found  a mm/s²  errors at", end="")
    print(", ".join(f" {feed:g}" for feed in FEEDS_IN_MIN), "in/min, %")
    for control in (ControlModelName.JUNCTION, ControlModelName.FIR):
        results = [_shown(seed, control) for seed in range(options.seeds)]
        _summary(control, [each for each in results if each is not None])
    _shown(0, ControlModelName.EXACT_STOP)


def _shown(seed: int, control: ControlModelName) -> MachineResult | None:
    """Print the row of a machine."""
    hidden = drawn(seed, control)
    time = 1e3 * (hidden.machine.block_time or 0.0)
    head = f"{control.value:10} {seed:3} {time:17.3f}"
    try:
        with TemporaryDirectory() as folder:
            result = found_on(hidden, Path(folder))
    except CalibrationError as error:
        print(f"{head}  {error}")
        return None
    errors = " ".join(f"{100.0 * each.error:+6.2f}" for each in result.spirals)
    acceleration = hidden.machine.axes[0].acceleration
    print(f"{head} {1e3 * result.block_time:7.3f} {acceleration:8.0f}  {errors}", flush=True)
    return result


def _summary(control: ControlModelName, results: list[MachineResult]) -> None:
    """Print the greatest errors of a control, and the mean times by feed."""
    worst = max(abs(each.error) for found in results for each in found.spirals)
    blocks = max(
        abs(each.block_time / (each.hidden.machine.block_time or 1.0) - 1.0) for each in results
    )
    print(
        f"{control.value}: {len(results)} machines, greatest error of the cycle time "
        f"{100.0 * worst:.2f} %, of the block time {100.0 * blocks:.3f} %"
    )
    for row, feed in enumerate(FEEDS_IN_MIN):
        spirals = [each.spirals[row] for each in results]
        theoretical, predicted, actual = (
            float(np.mean([getattr(each, name) for each in spirals]))
            for name in ("theoretical", "predicted", "actual")
        )
        print(
            f"  {feed:5g} in/min, mean: theoretical {theoretical:6.2f} s, predicted "
            f"{predicted:6.2f} s, actual {actual:6.2f} s"
        )


if __name__ == "__main__":
    main()
