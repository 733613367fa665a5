"""Reading ISO 10303-21: our index and full parse beside steputils, on one generated file.

Each reader runs in a process of its own, so that the peak of its memory is its own; time is
CPU time without imports. ``python -m benchmarks.part21 --megabytes 30``
"""

import argparse
import json
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from random import Random

from stepnc_model.part21.reader import Part21File

BYTES_PER_MB = 1e6
KIB_PER_MIB = 1024.0
HEADER = (
    "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION(('generated'),'2;1');\n"
    "FILE_NAME('bench','2024-01-01',(''),(''),'','','');\n"
    "FILE_SCHEMA(('MACHINING_SCHEMA'));\nENDSEC;\nDATA;\n"
)
FOOTER = "ENDSEC;\nEND-ISO-10303-21;\n"


@dataclass(frozen=True, slots=True, kw_only=True)
class Run:
    """Time and memory of one reader."""

    reader: str
    megabytes: float
    seconds: float
    """CPU time"""
    peak: float
    """MiB, the whole process"""

    @property
    def rate(self) -> float:
        """MB/s."""
        return self.megabytes / self.seconds


def generate(path: Path, *, megabytes: float) -> None:
    """Write a file with the mix of entities of a large milling program."""
    random = Random(21)
    written, id = 0, 1
    with path.open("w", newline="\n") as file:
        file.write(HEADER)
        while written < megabytes * BYTES_PER_MB:
            block = _toolpath(random, first=id)
            text = "".join(f"#{id + i}={line};\n" for i, line in enumerate(block))
            comment = "/* next contour */\n" if random.random() < 0.02 else ""
            written += file.write(comment + text)
            id += len(block)
        file.write(FOOTER)


def _toolpath(random: Random, *, first: int) -> list[str]:
    """One workingstep with its path: points, a polyline, placement, technology."""

    def number() -> str:
        return f"{random.uniform(-250, 250):.4f}"

    count = random.randint(4, 12)
    points = [f"CARTESIAN_POINT('',({number()},{number()},{number()}))" for _ in range(count)]
    last = first + count
    references = ",".join(f"#{first + i}" for i in range(count))
    return [
        *points,
        f"POLYLINE('contour {first}',({references}))",
        "DIRECTION('',(0.,0.,1.))",
        f"AXIS2_PLACEMENT_3D('placement',#{first},#{last + 1},$)",
        f"CUTTER_LOCATION_TRAJECTORY(.T.,.TRAJECTORY_PATH.,$,#{last + 4},$,.T.,#{last},$,$)",
        f"MILLING_TECHNOLOGY({random.uniform(0.01, 0.1):.3f},.TCP.,$,-20.,$,.F.,.F.,.F.,$)",
        f"MACHINING_WORKINGSTEP('WS {first}; d''usinage',#{last + 2},#{last + 3},#{last},$)",
    ]


def _index(path: Path) -> int:
    return len(Part21File.from_bytes(path.read_bytes()))


def _parse(path: Path) -> int:
    file = Part21File.from_bytes(path.read_bytes())
    return sum(len(file.parameters(id)) >= 0 for id in file.ids())


def _check(path: Path) -> int:
    file = Part21File.from_bytes(path.read_bytes())
    return len(file) + len(file.findings)


def _steputils(path: Path) -> int:
    from steputils import p21  # noqa: PLC0415 - only the peer's process pays for it

    file = p21.loads(path.read_text())
    return sum(1 for section in file.data for _ in section.instances)


READERS: dict[str, Callable[[Path], int]] = {
    "index": _index,
    "index + all parameters": _parse,
    "index + all findings": _check,
    "steputils": _steputils,
}


def measure(reader: str, path: Path) -> Run:
    """Run a reader in a fresh process."""
    command = [sys.executable, "-m", "benchmarks.part21", "--read", reader, str(path)]
    answer = subprocess.run(command, check=True, capture_output=True, text=True)
    seconds, peak = json.loads(answer.stdout)
    megabytes = path.stat().st_size / BYTES_PER_MB
    return Run(reader=reader, megabytes=megabytes, seconds=seconds, peak=peak)


def _read(reader: str, path: Path) -> None:
    """Print CPU seconds and peak memory of this process."""
    READERS[reader](path.parent / "warm.stp")
    before = time.process_time()
    READERS[reader](path)
    seconds = time.process_time() - before
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / KIB_PER_MIB
    print(json.dumps([seconds, peak]))


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--megabytes", type=float, default=30.0)
    parser.add_argument("--peer-megabytes", type=float, help="a smaller file for steputils")
    parser.add_argument("--read", nargs=2, metavar=("READER", "FILE"), help=argparse.SUPPRESS)
    options = parser.parse_args(arguments)
    if options.read:
        _read(options.read[0], Path(options.read[1]))
        return
    with tempfile.TemporaryDirectory() as folder:
        large, small = Path(folder) / "large.stp", Path(folder) / "small.stp"
        generate(Path(folder) / "warm.stp", megabytes=0.001)
        generate(large, megabytes=options.megabytes)
        generate(small, megabytes=options.peer_megabytes or options.megabytes)
        runs = [
            measure(reader, small if reader == "steputils" else large) for reader in READERS
        ]
    _print_table(runs)


def _print_table(runs: list[Run]) -> None:
    peer = runs[-1]
    print("Parameters are parsed and not kept by ours, kept by steputils.")
    print(
        f"{'reader':24}{'MB':>7}{'MB/s':>8}{'peak MiB':>10}{'B/B':>6}{'faster':>8}{'leaner':>8}"
    )
    for run in runs:
        per_byte = run.peak * KIB_PER_MIB**2 / (run.megabytes * BYTES_PER_MB)
        faster = run.rate / peer.rate
        leaner = (peer.peak / peer.megabytes) / (run.peak / run.megabytes)
        print(
            f"{run.reader:24}{run.megabytes:7.1f}{run.rate:8.1f}{run.peak:10.0f}"
            f"{per_byte:6.1f}{faster:7.1f}x{leaner:7.1f}x"
        )


if __name__ == "__main__":
    main()
