"""Promised speeds beside measured ones: ``python -m benchmarks.promises --runs 3``.

A row is a function that does some work and returns its figure, with a unit and a goal. Each
measurement runs in a process of its own, so no row warms another up and the peak memory is that
of the row, its own child processes included.

To add a row, write a function without arguments, which imports what it measures, and add a
``Row`` to ``ROWS``.
"""

import argparse
import json
import os
import resource
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory

ROOT = Path(__file__).parents[1]
KIB_PER_MIB = 1024.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """A promised speed; smaller figures are better unless the goal is a least one."""

    name: str
    """Word that ``--only`` takes."""
    work: str
    measure: Callable[[], float]
    unit: str
    goal: float
    is_least: bool = False
    """True if the figure must be at least the goal."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Measurement:
    """Figure of one run, and the peak of its resident memory in MiB."""

    value: float
    memory: float


# Rows import within their functions: the peak memory of a process survives fork and exec, so
# the process that starts the others has to stay small.


def _closed_form() -> float:
    from benchmarks.workingsteps import microseconds_each  # noqa: PLC0415

    return microseconds_each()


def _pocket() -> float:
    from benchmarks.process import plate_usage  # noqa: PLC0415

    with TemporaryDirectory() as folder:
        few, many = (plate_usage(count, Path(folder)).cpu for count in (10, 40))
    return (many - few) / 30


def _bracket_cpu() -> float:
    from benchmarks.process import bracket_and_peer  # noqa: PLC0415

    return median(ours.cpu / peer.cpu for ours, peer in bracket_and_peer(5))


def _bracket_wall() -> float:
    from benchmarks.process import bracket_and_peer  # noqa: PLC0415

    return median(ours.wall / peer.wall for ours, peer in bracket_and_peer(5))


def _help() -> float:
    from benchmarks.process import OPTIMISE, usage  # noqa: PLC0415

    return min(usage([OPTIMISE, "--help"]).wall for _ in range(3))


def _control() -> float:
    from benchmarks.control_step import BRACKET, simulated_speed  # noqa: PLC0415
    from service.requests.advice import AdviceRequest  # noqa: PLC0415
    from service.verbs.optimise.program import advise_program  # noqa: PLC0415
    from service.verbs.optimise.request import AdviceFiles  # noqa: PLC0415

    with TemporaryDirectory() as folder:
        file = Path(folder) / BRACKET.name
        advise_program(AdviceRequest(machine="vmc15"), AdviceFiles(file=BRACKET, output=file))
        return simulated_speed(file)


def _current() -> float:
    from benchmarks.agent import current_ratio  # noqa: PLC0415

    return current_ratio()


def _shop() -> float:
    from benchmarks.factory import event_ratio  # noqa: PLC0415

    return event_ratio(hours=400.0)


def _long_shop() -> float:
    from benchmarks.factory import event_ratio  # noqa: PLC0415

    return event_ratio(hours=4000.0)


def _raster() -> float:
    # As in the command: a second thread of BLAS waits for work, and its waiting is CPU time.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    from benchmarks.nc_feeds import seconds_of  # noqa: PLC0415

    return seconds_of(100_000)


ROWS = (
    Row(
        name="workingstep",
        work="closed form of a workingstep",
        measure=_closed_form,
        unit="µs of CPU",
        goal=20.0,
    ),
    Row(
        name="pocket",
        work="each more pocket of a plate, along its real path",
        measure=_pocket,
        unit="s of CPU",
        goal=0.15,
    ),
    Row(
        name="bracket-cpu",
        work="optimise bracket over import numpy, lxml: CPU",
        measure=_bracket_cpu,
        unit="times",
        goal=10.0,
    ),
    Row(
        name="bracket-wall",
        work="optimise bracket over import numpy, lxml: wall",
        measure=_bracket_wall,
        unit="times",
        goal=10.0,
    ),
    Row(name="help", work="optimise --help", measure=_help, unit="s", goal=0.3),
    Row(
        name="control",
        work="bracket, optimised, under control with preview",
        measure=_control,
        unit="× real time",
        goal=100.0,
        is_least=True,
    ),
    Row(
        name="current",
        work="/current of the agent, arrivals at 20 Hz",
        measure=_current,
        unit="of bare route",
        goal=0.5,
        is_least=True,
    ),
    Row(
        name="factory",
        work="50 machines, 400 h, by parts",
        measure=_shop,
        unit="of bare SimPy",
        goal=0.5,
        is_least=True,
    ),
    Row(
        name="long-factory",
        work="50 machines, 4000 h, by parts",
        measure=_long_shop,
        unit="of bare SimPy",
        goal=0.5,
        is_least=True,
    ),
    Row(
        name="nc-code",
        work="optimise 100 000 blocks of a raster",
        measure=_raster,
        unit="s of CPU",
        goal=30.0,
    ),
)


def is_kept(row: Row, value: float) -> bool:
    """True if a figure keeps the promise of its row."""
    return value >= row.goal if row.is_least else value <= row.goal


def measured(row: Row) -> Measurement:
    """Measure a row once in a new process."""
    answer = subprocess.run(
        [sys.executable, "-m", "benchmarks.promises", "--measure", row.name],
        cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True, env=_environment(),
    )  # fmt: skip
    return Measurement(**json.loads(answer.stdout.splitlines()[-1]))


def _environment() -> dict[str, str]:
    """Environment in which Python keeps its bytecode, as installed commands find it."""
    return {
        name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"
    }


def table_line(row: Row, runs: list[Measurement]) -> str:
    """Line of the table: work, median, spread, goal, whether it is kept, and peak memory."""
    values = [run.value for run in runs]
    now = median(values)
    spread = f"{min(values):.4g}…{max(values):.4g}"
    goal = f"{'≥' if row.is_least else '≤'} {row.goal:g}"
    kept = "yes" if is_kept(row, now) else "NO"
    memory = max(run.memory for run in runs)
    return f"{row.work:50}{now:10.4g}{spread:>18}{goal:>10} {row.unit:14}{kept:>5}{memory:8.0f}"


def main(arguments: list[str] | None = None) -> None:
    """Print the table of promises."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=1, help="measurements of each row")
    parser.add_argument("--only", nargs="*", default=[], metavar="NAME", help="only these rows")
    parser.add_argument("--measure", choices=[row.name for row in ROWS], help=argparse.SUPPRESS)
    options = parser.parse_args(arguments)
    if options.measure:
        _print_measurement(next(row for row in ROWS if row.name == options.measure))
        return
    unknown = set(options.only) - {row.name for row in ROWS}
    if unknown:
        parser.error(f"no row {', '.join(sorted(unknown))}: {', '.join(r.name for r in ROWS)}")
    print(f"{'work':50}{'now':>10}{'spread':>18}{'goal':>10} {'':14}{'met?':>5}{'MiB':>8}")
    for row in ROWS:
        if not options.only or row.name in options.only:
            print(table_line(row, [measured(row) for _ in range(options.runs)]), flush=True)


def _print_measurement(row: Row) -> None:
    """Measure a row in this process."""
    value = row.measure()
    # The greatest size that getrusage knows of a process counts what it was forked from.
    status = Path("/proc/self/status").read_text(encoding="ascii")
    own = int(status.split("VmHWM:")[1].split()[0])
    children = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
    memory = max(own, children) / KIB_PER_MIB
    print(json.dumps({"value": value, "memory": memory}))


if __name__ == "__main__":
    main()
