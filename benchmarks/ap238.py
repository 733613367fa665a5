"""Reading of large AP238 files beside the same programs of ISO 14649: time and memory.

The program is made here: workingsteps with an explicit tool path each, converted to AP238. Each
reading runs in a process of its own, so that the peak of its memory is its own; time is CPU
time without imports. ``python -m benchmarks.ap238 --megabytes 10 100`` (of AP238).
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

from benchmarks.part21 import BYTES_PER_MB, KIB_PER_MIB
from stepnc_model.ap238.export import to_ap238
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.generate import generate

POINTS = 20
"""Points of the tool path of one workingstep."""

PER_STEP = 4530.0
"""Bytes of one workingstep in AP238, about."""

HEAD = """ISO-10303-21;
HEADER;
FILE_DESCRIPTION(('generated'),'2;1');
FILE_NAME('bench','2025-01-01',(''),(''),'','','');
FILE_SCHEMA(('MACHINING_SCHEMA','MILLING_SCHEMA'));
ENDSEC;
DATA;
#1=PROJECT('BENCH',#2,(#3),$,$,$);
#3=WORKPIECE('PART',$,$,$,$,$,());
#4=TAPERED_ENDMILL(#5,2,.RIGHT.,.F.,$,$);
#5=MILLING_TOOL_DIMENSION(10.,$,$,20.,$,$,$);
#6=MILLING_CUTTING_TOOL('MILL 10MM',#4,(),80.,$,$);
#7=MILLING_MACHINE_FUNCTIONS(.F.,$,$,.F.,$,(),.F.,$,$,());
#8=AXIS2_PLACEMENT_3D('',#9,$,$);
#9=CARTESIAN_POINT('',(0.,0.,0.));
#10=TOOLPATH_FEATURE('PATHS',#3,(),#8,#11);
#11=PLANE('',#8);
"""
FIRST = 20
"""First number of the workingsteps' instances."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Reading:
    """Time and memory of one reading."""

    seconds: float
    """CPU time"""
    peak: float
    """MiB, the whole process"""
    count: int
    """Workingsteps, or moves of their paths."""


def program(steps: int) -> str:
    """Program of ISO 14649 with a number of workingsteps."""
    lines, names, first = [HEAD], list[str](), FIRST
    for number in range(steps):
        lines.append(_workingstep(number, first))
        first += POINTS + 6
        names.append(f"#{first - 1}")
    lines.append(
        f"#2=WORKPLAN('MAIN',({','.join(names)}),$,$,$);\nENDSEC;\nEND-ISO-10303-21;\n"
    )
    return "".join(lines)


def _workingstep(number: int, first: int) -> str:
    """Instances of one workingstep and its path."""
    points = "".join(
        f"#{first + i}=CARTESIAN_POINT('',({(7 * number + 3 * i) % 250}.25,"
        f"{(3 * number + 5 * i) % 250}.5,-{i % 5}.));\n"
        for i in range(POINTS)
    )
    refs = ",".join(f"#{first + i}" for i in range(POINTS))
    curve = first + POINTS
    return (
        f"{points}#{curve}=POLYLINE('',({refs}));\n"
        f"#{curve + 1}=MILLING_TECHNOLOGY(0.0{number % 8 + 1},.TCP.,$,-20.,$,.F.,.F.,.F.,$);\n"
        f"#{curve + 2}=CUTTER_LOCATION_TRAJECTORY(.T.,.TRAJECTORY_PATH.,$,$,$,.T.,#{curve},"
        "$,$);\n"
        f"#{curve + 3}=TOOLPATH_LIST((#{curve + 2}));\n"
        f"#{curve + 4}=FREEFORM_OPERATION(#{curve + 3},$,'MILL {number}',$,$,#6,#{curve + 1},"
        "#7,$,$,$,$);\n"
        f"#{curve + 5}=MACHINING_WORKINGSTEP('STEP {number}',#11,#10,#{curve + 4},$);\n"
    )


def _workingsteps(path: Path) -> int:
    """Read a program and resolve its workingsteps."""
    return len(Program(Part21File.from_bytes(path.read_bytes())).workingsteps)


def _paths(path: Path) -> int:
    """Read a program and make its tool paths, one after another."""
    made = generate(Program(Part21File.from_bytes(path.read_bytes())))
    return sum(len(getattr(each, "steps", ())) for each in made)


CONVERSION = "conversion"

READINGS: dict[str, Callable[[Path], int]] = {"workingsteps": _workingsteps, "paths": _paths}


def measure(reading: str, path: Path) -> Reading:
    """Read a file, or convert it, in a fresh process."""
    command = [sys.executable, "-m", "benchmarks.ap238", "--read", reading, str(path)]
    answer = subprocess.run(command, check=True, capture_output=True, text=True)
    seconds, peak, count = json.loads(answer.stdout)
    return Reading(seconds=seconds, peak=peak, count=count)


def _read(reading: str, path: Path) -> None:
    """Print CPU seconds, peak memory and count of this process."""
    if reading != CONVERSION:
        READINGS[reading](path.parent / f"warm{path.suffix}")
    before = time.process_time()
    count = _converted(path) if reading == CONVERSION else READINGS[reading](path)
    seconds = time.process_time() - before
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / KIB_PER_MIB
    print(json.dumps([seconds, peak, count]))


def _converted(path: Path) -> int:
    """Convert a program of ISO 14649 to AP238, beside it; return its bytes."""
    data = to_ap238(Part21File.from_bytes(path.read_bytes())).data
    path.with_suffix(".238").write_bytes(data)
    return len(data)


def main(arguments: list[str] | None = None) -> None:
    """Print a row for each size and reading."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--megabytes", type=float, nargs="+", default=[10.0, 100.0])
    parser.add_argument("--read", nargs=2, metavar=("READING", "FILE"), help=argparse.SUPPRESS)
    options = parser.parse_args(arguments)
    if options.read:
        _read(options.read[0], Path(options.read[1]))
        return
    for megabytes in options.megabytes:
        with tempfile.TemporaryDirectory() as folder:
            place = Path(folder)
            (place / "warm.stpnc").write_text(program(1), encoding="ascii")
            measure(CONVERSION, place / "warm.stpnc")
            steps = max(1, round(megabytes * BYTES_PER_MB / PER_STEP))
            (place / "large.stpnc").write_text(program(steps), encoding="ascii")
            _print(place / "large.stpnc")


def _print(iso: Path) -> None:
    """Rows of one program."""
    made = measure(CONVERSION, iso)
    aim = iso.with_suffix(".238")
    size, other = (path.stat().st_size / BYTES_PER_MB for path in (aim, iso))
    print(
        f"{size:.1f} MB of AP238 from {other:.1f} MB of ISO 14649: converted in "
        f"{made.seconds:.1f} s with {made.peak:.0f} MiB"
    )
    heads = ("reading", "ISO s", "AP238 s", "ratio", "MB/s", "ISO MiB", "AP238 MiB", "B/B")
    print("".join(f"{head:>14}" for head in heads))
    for reading in READINGS:
        one, two = measure(reading, iso), measure(reading, aim)
        if one.count != two.count:
            raise ValueError(f"{reading}: {one.count} of ISO 14649, {two.count} of AP238")
        per_byte = two.peak * KIB_PER_MIB**2 / aim.stat().st_size
        print(
            f"{reading:>14}{one.seconds:14.2f}{two.seconds:14.2f}"
            f"{two.seconds / one.seconds:14.1f}{size / two.seconds:14.2f}"
            f"{one.peak:14.0f}{two.peak:14.0f}{per_byte:14.1f}",
            flush=True,
        )


if __name__ == "__main__":
    main()
