"""``optimise`` as a whole process: the sample bracket, and plates of 10, 100 and 1000 pockets.

The bracket and its peer, ``import numpy, lxml.etree``, run in turn, so that a machine that
slows down slows both; their ratio is that of pairs. Plates run once, on the cores that are
there. CPU seconds are those of all processes; those of each more pocket are against the plate
before, and growth is their ratio: 1 is linear.
"""

import argparse
import os
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from statistics import median

from benchmarks.plates import plate

BRACKET = Path(__file__).parents[1] / "examples" / "parts" / "bracket.stpnc"
OPTIMISE = str(Path(sys.executable).with_name("optimise"))
PEER = [sys.executable, "-c", "import numpy, lxml.etree"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Usage:
    """Time and memory of one process."""

    cpu: float
    """s, user and system"""
    wall: float
    """s"""
    memory: float
    """MB, greatest of one process"""


def main(arguments: list[str] | None = None) -> None:
    """Print CPU and wall seconds, memory and ratios."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=7)
    parser.add_argument("--pockets", type=int, nargs="*", default=[10, 100, 1000])
    options = parser.parse_args(arguments)
    pairs = bracket_and_peer(options.runs)
    helps = [usage([OPTIMISE, "--help"]) for _ in range(options.runs)]
    with tempfile.TemporaryDirectory() as folder:
        print(f"{'process':30}{'CPU s':>9}{'wall s':>9}{'MB':>7}")
        _print("import numpy, lxml.etree", [other for _, other in pairs])
        _print("optimise --help", helps)
        _print("optimise bracket.stpnc", [one for one, _ in pairs])
        cpu = median(one.cpu / other.cpu for one, other in pairs)
        wall = median(one.wall / other.wall for one, other in pairs)
        print(f"ratios of CPU and wall, median of {len(pairs)} pairs: {cpu:.2f}, {wall:.2f}")
        _print_growth(options.pockets, Path(folder))


def bracket_and_peer(runs: int) -> list[tuple[Usage, Usage]]:
    """Usages of the bracket and of its peer, in turn, after one run that warms the caches."""
    with tempfile.TemporaryDirectory() as folder:
        output = str(Path(folder) / "bracket.stpnc")
        ours = [OPTIMISE, str(BRACKET), "--mode", "TC", "--machine", "vmc15", "-o", output]
        usage(ours), usage(PEER)  # warm the disk, the bytecode and the kernels
        return [(usage(ours), usage(PEER)) for _ in range(runs)]


def plate_usage(pockets: int, folder: Path) -> Usage:
    """Usage of a plate with some pockets."""
    file = folder / "plate.stpnc"
    file.write_text(plate(pockets), encoding="utf-8")
    output = str(folder / "plate.out.stpnc")
    return usage([OPTIMISE, str(file), "--machine", "vmc15", "-o", output])


def _print(name: str, usages: list[Usage]) -> None:
    """One line of medians."""
    cpu, wall = median(each.cpu for each in usages), median(each.wall for each in usages)
    memory = median(each.memory for each in usages)
    print(f"{name:30}{cpu:9.2f}{wall:9.2f}{memory:7.0f}")


def _print_growth(counts: list[int], folder: Path) -> None:
    """One line a plate."""
    print(
        f"\n{'pockets':>8}{'CPU s':>9}{'wall s':>9}{'MB':>7}{'ms more each':>14}{'growth':>8}"
    )
    before, first = None, 0.0
    for count in counts:
        used = plate_usage(count, folder)
        line = f"{count:8}{used.cpu:9.2f}{used.wall:9.2f}{used.memory:7.0f}"
        if before is not None:
            each = (used.cpu - before[1]) / (count - before[0])
            first = first or each
            line += f"{each * 1e3:14.1f}{each / first:8.2f}"
        print(line)
        before = count, used.cpu


def usage(command: list[str]) -> Usage:
    """Time and memory of one run."""
    start = time.perf_counter()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise subprocess.CalledProcessError(process.returncode, command)
    return Usage(
        cpu=used.ru_utime + used.ru_stime,
        wall=time.perf_counter() - start,
        memory=used.ru_maxrss / 1024.0,
    )


if __name__ == "__main__":
    main()
