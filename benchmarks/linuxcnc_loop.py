"""Control laws on a real LinuxCNC: steps of hardness and depth that the loop does not know.

The first 40 mm of ``paper002`` run in real time, with the force of our own process behind the
real motion. The set point is a sixth above the force of the programmed feed, so that a step has
to be taken back. Times and excess are those of the loop's record.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.linuxcnc_faults import PART, short_program
from controller.laws.choice import LawName
from service.requests.runs import ControlRequest
from service.verbs.control.request import ControlFiles
from service.verbs.control.run import run

SET_POINT = 240.0
"""N; the programmed feed needs 206 N."""

LAWS = (LawName.NONE, LawName.PI, LawName.LOG_PI, LawName.MPC)
STEPS = {"hardness +40 %": "hardness:+40%@18s", "depth +30 %": "depth:+30%@18s"}
"""Steps that the loop does not know, when half of the part is cut."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopRun:
    """One run of the loop on the control."""

    law: LawName
    step: str
    over: float
    """Time with a force above 1.05 times the set point, s."""
    excess: float
    """Impulse above the set point, N·s."""
    peak: float
    """Greatest mean force of a revolution, N."""
    least: float
    """Least override with chips."""
    time: float
    """Time of the program, s."""


def runs(
    laws: tuple[LawName, ...] = LAWS, steps: tuple[str, ...] = tuple(STEPS)
) -> Iterator[LoopRun]:
    """Run laws under steps, one after another."""
    with TemporaryDirectory() as name:
        folder = Path(name)
        code = short_program(folder)
        for step in steps:
            for law in laws:
                yield _run(law, step, code)


def _run(law: LawName, step: str, code: Path) -> LoopRun:
    request = ControlRequest(
        machine="vmc15",
        law=law,
        force_set_point_n=SET_POINT,
        disturbances=(STEPS[step],),
    )
    found = run(request, ControlFiles(file=PART, nc=code, linuxcnc="bench")).run
    records = [record for advice, record in found.steps if advice is not None]
    return LoopRun(
        law=law,
        step=step,
        over=sum(each.over_time for each in records),
        excess=sum(each.excess for each in records),
        peak=max(each.peak for each in records),
        least=min(each.least for each in records),
        time=found.time,
    )


def print_runs() -> None:
    """Print a table of all laws and steps."""
    print(
        "| step | law | s over | excess N·s | peak N | least override | time s | to open loop |"
    )
    print("|---|---|---|---|---|---|---|---|")
    open_time = 0.0
    for each in runs():
        if each.law is LawName.NONE:
            open_time = each.time
        name = "open loop" if each.law is LawName.NONE else each.law.value
        print(
            f"| {each.step} | {name} | {each.over:.2f} | {each.excess:.0f} | {each.peak:.0f} | "
            f"{each.least:.0%} | {each.time:.1f} | {each.time / open_time - 1.0:+.1%} |",
            flush=True,
        )


if __name__ == "__main__":
    print_runs()
