"""Feeds of foreign NC programs: what is planned, what its run finds, what a second run does.

``python -m benchmarks.nc_samples FOLDER`` takes all programs in a folder, such as LinuxCNC's
``nc_files``. They state no tools and no stock, so each gets end mills (a lathe gets inserts)
and a block around its moves; programs that start no spindle get ``S3000 M3`` in their first
line. The output is run by ``simulate --nc --keep-going`` as well.
"""

import argparse
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from service.requests.advice import AdviceRequest
from service.requests.runs import SimulationRequest
from service.simulation.code_simulation import CodeRequest
from service.simulation.run import RunFiles, Simulation, simulate
from service.verbs.optimise.code import optimise_code
from service.verbs.optimise.code_result import CodeAdvice
from service.verbs.optimise.request import AdviceFiles
from stepnc_model.errors import StepNcError
from stepnc_model.nc.program import NcProgram, read_program
from stepnc_model.post.blocks import MachineType
from stepnc_model.post.dialect import Dialect

SUFFIXES = {".ngc", ".nc", ".tap"}
SPINDLE = b"S3000 M3\n"
MOST_BLOCKS = 2000
"""Longest program that is planned, in moves."""

MILL = "number,kind,diameter_mm,corner_radius_mm,teeth\n"
LATHE = "number,kind,nose_radius_mm,width_mm,cutting_edge_angle_deg\n"


@dataclass(frozen=True, slots=True, kw_only=True)
class Sample:
    """NC program with the tools and the stock that it gets."""

    name: str
    data: bytes
    request: AdviceRequest
    tools: str
    """Tool table as CSV."""

    def simulated(self, data: bytes, folder: Path) -> Simulation:
        """Run of the program, or of what became of it."""
        request = SimulationRequest(
            machine=self.request.machine, material=self.request.material, keep_going=True
        )
        return simulate(request, RunFiles(code=self._code(data, folder)))

    def _code(self, data: bytes, folder: Path) -> CodeRequest:
        file, tools = folder / self.name, folder / "tools.csv"
        file.write_bytes(data)
        tools.write_text(self.tools)
        dialect = self.request.dialect
        return CodeRequest(
            code=file,
            dialect="" if dialect is None else dialect.value,
            tools=tools,
            stock=self.request.stock,
        )

    def advised(self, data: bytes, folder: Path) -> CodeAdvice:
        """Feeds along the paths of the program, or of what became of it."""
        code = self._code(data, folder)
        files = AdviceFiles(file=code.code, tools=code.tools, dry_run=True)
        return optimise_code(self.request, files)


def sample_of(
    file: Path,
    *,
    diameter: float = 8.0,
    levels: int | None = None,
    dialect: Dialect = Dialect.LINUXCNC,
) -> Sample | None:
    """Program with tools and stock; None if none of its feeds may change.

    Parameters
    ----------
    file : Path
    diameter : float, mm
        Diameter of its end mills.
    levels : int or None
        Largest number of feeds in each part; None: any.
    dialect : Dialect

    Raises
    ------
    StepNcError
        When the program cannot be read.
    """
    data = file.read_bytes()
    program = read_program(data, dialect=dialect)
    moves = program.moves
    if (np.isnan(moves.spindle) | (moves.spindle == 0.0)).all():
        data = SPINDLE + data
        program = read_program(data, dialect=dialect, machine=program.machine)
    moves = program.moves
    if not moves.is_advisable.any() or len(moves) > MOST_BLOCKS:
        return None
    is_lathe = program.machine is MachineType.LATHE
    tools = sorted({int(tool) for tool in np.unique(moves.tool[moves.is_advisable])} - {-1})
    rows = (
        f"{n},turning,0.4,,93\n" if is_lathe else f"{n},endmill,{diameter:g},0,3\n"
        for n in tools or [1]
    )
    return Sample(
        name=file.name,
        data=data,
        request=AdviceRequest(
            machine="lathe22" if is_lathe else "vmc15",
            material="c45",
            stock=_bar(program) if is_lathe else _box(program),
            dialect=dialect,
            levels=levels,
        ),
        tools=(LATHE if is_lathe else MILL) + "".join(rows),
    )


def _ends(program: NcProgram) -> tuple[list[float], list[float]]:
    """Least and greatest coordinates of the moves whose feeds may change."""
    moves = program.moves
    rows = moves.is_advisable
    points = np.concatenate((moves.start[rows], moves.end[rows]))
    return points.min(axis=0).tolist(), points.max(axis=0).tolist()


def _box(program: NcProgram) -> str:
    """Block around the moves, up to 60 % of their height and half a millimetre more."""
    low, high = _ends(program)
    top = low[2] + 0.6 * (high[2] - low[2]) + 0.5
    numbers = (low[0] - 2.0, low[1] - 2.0, low[2] - 8.0, high[0] + 2.0, high[1] + 2.0, top)
    return ",".join(f"{number:g}" for number in numbers)


def _bar(program: NcProgram) -> str:
    """Bar around the moves."""
    low, high = _ends(program)
    return f"{2.0 * max(high[0], 1.0):g},{low[2] - 10.0:g},{high[2] - 1.0:g}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """One sample in the table."""

    name: str
    advice: CodeAdvice
    run: float
    """Time of ``simulate --nc`` on the output, s."""
    left_out: int
    """Number of reasons for which lines are left out of this run."""
    is_same: bool
    """Whether a second run on the output leaves all bytes."""


def rows_of(folder: Path) -> Iterator[Row | str]:
    """Yield the samples of a folder that are planned, and why others are not."""
    for file in sorted(each for each in folder.rglob("*") if each.suffix in SUFFIXES):
        try:
            sample = sample_of(file)
            if sample is None:
                continue
            with tempfile.TemporaryDirectory() as place:
                first = sample.advised(sample.data, Path(place))
                second = sample.advised(first.rewritten.data, Path(place))
                run = sample.simulated(first.rewritten.data, Path(place))
        except StepNcError as error:
            yield f"{file.name}: {error}"
            continue
        is_same = second.rewritten.data == first.rewritten.data
        yield Row(
            name=file.name,
            advice=first,
            run=run.whole.duration,
            left_out=sum("left out of the run" in each.message for each in run.findings),
            is_same=is_same,
        )


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the samples of a folder."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    given = parser.parse_args(arguments)
    print(
        f"{'program':52s} {'changed':>7s} {'added':>5s} {'before s':>9s} {'after s':>9s} "
        f"run/plan 2nd run {'simulated s':>11s} left out"
    )
    for row in rows_of(given.folder):
        if isinstance(row, str):
            print(row)
            continue
        along, code = row.advice.along, row.advice.rewritten
        print(
            f"{row.name:52s} {code.changed:7d} {code.added:5d} {along.time_before:9.2f} "
            f"{along.time_after:9.2f} {along.time_after / along.planned_time:8.4f} "
            f"{'same' if row.is_same else 'CHANGED':>7s} {row.run:11.2f} {row.left_out:8d}"
        )


if __name__ == "__main__":
    main()
