"""The virtual machine: simulated seconds a second, samples, bytes, and memory by hours.

The peer is the file of samples itself, read back by pyarrow: how long a run takes beside
reading what it wrote. ``python -m benchmarks.simulation --hours 1 10``
"""

import argparse
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from itertools import islice
from math import sin
from pathlib import Path

from pyarrow import parquet

from service.requests.runs import SimulationRequest
from service.simulation.code_simulation import CodeRequest
from service.simulation.run import RunFiles, simulate
from simulator.motion.model_name import ControlModelName

SPEED = 20.0
"""mm/s of the long program"""

CHORD = 2.0
"""mm of each of its moves"""

TOOLS = """[[tool]]
number = 1
kind = "endmill"
diameter_mm = 10
teeth = 4
"""


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--hours", type=float, nargs="*", default=[1.0, 10.0])
    parser.add_argument("--child", type=float, default=0.0, help=argparse.SUPPRESS)
    options = parser.parse_args(arguments)
    if options.child:
        _long_run(options.child)
        return
    part = Path(__file__).parent.parent / "examples" / "parts" / "bracket.stpnc"
    simulate(
        SimulationRequest(), RunFiles(file=part)
    )  # what is compiled and read once does not count
    header = f"{'simulated s/s':>13}  {'samples/s':>10}  bytes/sample"
    print(f"{'bracket, samples at':>22}  {header}")
    for rate in (10.0, 1000.0):
        _speed(part, rate)
    print(f"{'hours of 2 mm moves':>22}  {'blocks':>13}  {'seconds':>10}  peak memory MB")
    for hours in options.hours:
        command = [sys.executable, "-m", "benchmarks.simulation", "--child", str(hours)]
        run = subprocess.run(command, check=True, capture_output=True, text=True)
        print(run.stdout.rstrip())


def _speed(part: Path, rate: float) -> None:
    """One line: the bracket at one sampling rate."""
    with tempfile.TemporaryDirectory() as folder:
        output = Path(folder) / "run.parquet"
        start = time.perf_counter()
        run = simulate(SimulationRequest(rate_hz=rate), RunFiles(file=part, output=output))
        taken = time.perf_counter() - start
        start = time.perf_counter()
        parquet.read_table(output)
        read = time.perf_counter() - start
        size = output.stat().st_size / run.samples
    print(
        f"{rate:19g} Hz  {run.whole.duration / taken:13.0f}  {run.samples / taken:10.0f}  "
        f"{size:12.1f}  ({taken / read:.0f} times as long as reading it)"
    )


def _long_run(hours: float) -> None:
    """One line: a long program in a process of its own."""
    with tempfile.TemporaryDirectory() as folder:
        code, tools = Path(folder) / "long.ngc", Path(folder) / "tools.toml"
        tools.write_text(TOOLS)
        blocks = int(hours * 3600.0 * SPEED / CHORD)
        with code.open("w") as file:
            file.writelines(islice(_lines(), blocks))
            file.write("M2\n")
        request = SimulationRequest(
            machine="vmc15", material="c45", control=ControlModelName.JUNCTION, rate_hz=10.0
        )
        files = RunFiles(
            code=CodeRequest(code=code, tools=tools, stock="0,0,-20,120,100,0"),
            output=Path(folder) / "run.parquet",
        )
        start = time.perf_counter()
        simulate(request, files)
        taken = time.perf_counter() - start
    status = Path("/proc/self/status").read_text().splitlines()
    peak = next(int(line.split()[1]) for line in status if line.startswith("VmHWM"))
    print(f"{hours:20g} h  {blocks:13}  {taken:10.1f}  {peak / 1024.0:14.0f}")


def _lines() -> Iterator[str]:
    """NC code of strokes along waves, level after level."""
    yield "G21 G90 G54 G17\n"
    yield "T1 M6\n"
    yield "S6000 M3\n"
    yield "G0 X10 Y10 Z5\n"
    level = 0
    while True:
        level += 1
        depth = -0.5 * (level % 30)
        for stroke in range(20):
            y = 10.0 + 4.0 * stroke
            for step in range(50):
                x = 10.0 + CHORD * (step if stroke % 2 == 0 else 49 - step)
                height = depth + 0.2 * sin(x)
                yield f"G1 X{x:.3f} Y{y:.3f} Z{height:.3f} F{60.0 * SPEED:g}\n"


if __name__ == "__main__":
    main()
