"""Cost of a control step: by law, by cycle of the whole loop, and for a whole program.

Laws answer again what they were asked in a trial of ``tests/closed_loop/trials.py``; a cycle of
the loop is one tooth period, timed without the virtual machine that it waits for. A revolution
at 3000 rpm takes 20 000 µs, a period of one of its two teeth 10 000 µs.
``python -m benchmarks.control_step``
"""

import argparse
import gc
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from controller.laws.choice import LawName
from controller.laws.law import ControlLaw, Situation
from controller.signals.ports import Reading
from controller.signals.preview import LOOK_AHEAD
from service.control.run import prepare
from service.requests.runs import ControlRequest
from service.simulation.run import RunFiles
from simulator.plant.controlled_machine import ControlledMachine
from tests.closed_loop.trials import KNOWN, LAWS, Trial, law_of, loop, machine, run

BRACKET = Path(__file__).parents[1] / "examples" / "parts" / "bracket.stpnc"

ROUNDS = 20
"""that a law answers a trial's situations"""

NS_PER_US = 1000.0


@dataclass(frozen=True, slots=True, kw_only=True)
class StepCost:
    """Of one step, µs: CPU time is the step's own, the wall clock also waits for others."""

    cpu: float
    """mean"""
    cpu_p99: float
    wall: float
    """mean"""
    wall_p99: float


@dataclass(kw_only=True)
class _Clocks:
    """Time that goes by. Running state."""

    wall: int = 0
    """ns"""
    cpu: int = 0
    """ns"""

    def start(self) -> None:
        self.cpu -= time.thread_time_ns()
        self.wall -= time.perf_counter_ns()

    def stop(self) -> None:
        self.wall += time.perf_counter_ns()
        self.cpu += time.thread_time_ns()


class _Timed:
    """A machine that stops the clocks of its loop while it runs. Running state."""

    def __init__(self, on: ControlledMachine, clocks: _Clocks) -> None:
        self._on, self._clocks = on, clocks

    def read(self) -> Reading | None:
        self._clocks.stop()
        reading = self._on.read()
        self._clocks.start()
        return reading

    def set(self, override: float, /) -> None:
        self._on.set(override)


def main(arguments: list[str] | None = None) -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--look-ahead", type=int, default=LOOK_AHEAD)
    parser.add_argument("--rounds", type=int, default=ROUNDS)
    options = parser.parse_args(arguments)
    print(
        "| law | preview | µs a step, CPU | p99 | wall | p99 | µs a cycle, CPU | p99 | wall |"
    )
    print("|---|---|---|---|---|---|---|---|---|")
    for name in LAWS:
        for look_ahead in (0, options.look_ahead):
            trial = replace(KNOWN, look_ahead=look_ahead)
            step = step_cost(name, trial, rounds=options.rounds)
            cycle = cycle_cost(name, trial)
            print(
                f"| {name} | {look_ahead or '–'} | {step.cpu:.1f} | {step.cpu_p99:.1f} | "
                f"{step.wall:.1f} | {step.wall_p99:.1f} | {cycle.cpu:.0f} | "
                f"{cycle.cpu_p99:.0f} | {cycle.wall:.0f} |"
            )
    print(
        "\n| bracket.stpnc, log-pi | cycles | simulated s | wall s | CPU s | simulated s/s | |"
    )
    print("|---|---|---|---|---|---|---|")
    for has_preview in (False, True):
        _program(has_preview=has_preview)


def step_cost(name: LawName, trial: Trial, *, rounds: int = ROUNDS) -> StepCost:
    """Of a law alone."""
    asked, law = run(name, trial).situations, law_of(name, trial)
    gc.disable()  # as timeit does
    taken = [each for _ in range(rounds) for each in _steps(law, asked)]
    gc.enable()
    return _cost(taken)


def cycle_cost(name: LawName, trial: Trial) -> StepCost:
    """Of the whole loop, without the machine."""
    clocks = _Clocks()
    taken: list[tuple[int, int]] = []
    looped = loop(_Timed(machine(trial), clocks), law_of(name, trial), trial)
    while True:
        clocks.start()
        cycle = looped.cycle()
        clocks.stop()
        if cycle is None:
            return _cost(taken)
        taken.append((clocks.wall, clocks.cpu))
        clocks.wall = clocks.cpu = 0


def _steps(law: ControlLaw[Any], asked: Sequence[Situation]) -> list[tuple[int, int]]:
    """Ns of each step by the wall clock and of CPU time."""
    state, taken = law.begin(1.0), []
    for at in asked:
        clocks = _Clocks()
        clocks.start()
        state, _ = law.decide(state, at)
        clocks.stop()
        taken.append((clocks.wall, clocks.cpu))
    return taken


def _cost(taken: Sequence[tuple[int, int]]) -> StepCost:
    """Of steps that took so many ns by the wall clock and of CPU time."""
    wall, cpu = np.array(taken).T / NS_PER_US
    return StepCost(
        cpu=float(cpu.mean()),
        cpu_p99=float(np.quantile(cpu, 0.99)),
        wall=float(wall.mean()),
        wall_p99=float(np.quantile(wall, 0.99)),
    )


def simulated_speed(file: Path, *, rounds: int = 3) -> float:
    """Machining time over CPU time of a program under control with preview, the best of some.

    Preparation is left out; rows are made as for a file.
    """
    return max(_simulated_speed(file) for _ in range(rounds))


def _simulated_speed(file: Path) -> float:
    session = prepare(ControlRequest(machine="vmc15", has_preview=True), RunFiles(file=file))
    begin = time.process_time()
    with session.trace() as trace:
        for _ in session.cycles((trace,)):
            pass
    return session.machine.time / (time.process_time() - begin)


def _program(*, has_preview: bool) -> None:
    """One line: the bracket under control, after everything is prepared."""
    session = prepare(ControlRequest(has_preview=has_preview), RunFiles(file=BRACKET))
    start, cpu = time.perf_counter(), time.process_time()
    cycles = sum(1 for _ in session.cycles())
    taken, cpu = time.perf_counter() - start, time.process_time() - cpu
    done = session.result()
    end = f"stopped: {done.events[-1].text}" if done.is_stopped else "whole program"
    print(
        f"| {'preview' if has_preview else 'no preview'} | {cycles} | {done.time:.0f} | "
        f"{taken:.1f} | {cpu:.1f} | {done.time / taken:.0f} | {end} |"
    )


if __name__ == "__main__":
    main()
