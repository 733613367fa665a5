"""Feeds along the paths of a long NC program: time and memory by stage.

``python -m benchmarks.nc_feeds`` plans a raster over a wavy surface with a ball mill; a number
gives its blocks, such as 1000000. ``--file 100`` reads and rewrites a program of 100 MB alone.
"""

import argparse
import resource
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from math import cos, sin, sqrt
from pathlib import Path

from service.requests.advice import AdviceRequest
from service.verbs.optimise.code import optimise_code
from service.verbs.optimise.request import AdviceFiles
from stepnc_model.nc.advice import BlockAdvice
from stepnc_model.nc.program import read_program
from stepnc_model.nc.rewrite import rewrite

SIDE = 100.0
"""Side of the surface, mm."""

BLOCK_BYTES = 22
"""Usual length of a block."""

REWRITTEN_SHARE = 1000
"""One block in so many gets another feed where only reading and writing is measured."""

TOOLS = "number,kind,diameter_mm,corner_radius_mm,teeth\n6,endmill,6,3,2\n"
REQUEST = AdviceRequest(machine="vmc15", material="c45", stock=f"0,0,-20,{SIDE:g},{SIDE:g},0")


def raster(blocks: int) -> Iterator[str]:
    """Yield the blocks of a raster over a wavy surface."""
    yield from ("%", "O0001", "G21 G90 G17 G54", "T6 M6", "S8000 M3", "G0 X0. Y0. Z10.")
    rows = max(2, int(sqrt(blocks / 4)))
    per_row = blocks // rows
    yield "G1 Z-3. F1200."
    for row in range(rows):
        y = SIDE * row / (rows - 1)
        for step in range(per_row):
            x = SIDE * (step if row % 2 == 0 else per_row - 1 - step) / (per_row - 1)
            yield f"X{x:.3f}Y{y:.3f}Z{-3.0 + 1.5 * sin(x / 9.0) * cos(y / 11.0):.3f}"
    yield from ("G0 Z20.", "M30", "%")


def peak_mb() -> float:
    """Greatest memory of this process so far, MB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


@contextmanager
def timed(what: str, blocks: int) -> Iterator[None]:
    """Print the time of a stage, by block, and the greatest memory so far."""
    begin = time.perf_counter()
    yield
    seconds = time.perf_counter() - begin
    print(
        f"{what:20s} {seconds:8.2f} s  {1e6 * seconds / blocks:7.1f} µs/block  "
        f"peak {peak_mb():6.0f} MB"
    )


def plan(blocks: int) -> None:
    """Print the time of planning and rewriting a raster."""
    with tempfile.TemporaryDirectory() as folder:
        file, tools = Path(folder) / "raster.nc", Path(folder) / "tools.csv"
        file.write_text("\n".join(raster(blocks)) + "\n")
        tools.write_text(TOOLS)
        with timed(f"{blocks} blocks", blocks):
            code = optimise_code(REQUEST, AdviceFiles(file=file, tools=tools, dry_run=True))
    print(
        f"{code.along.time_before:.1f} -> {code.along.time_after:.1f} s, "
        f"{code.rewritten.changed} blocks changed, {code.rewritten.added} added"
    )


def seconds_of(blocks: int) -> float:
    """CPU time of planning and rewriting a raster, s; kernels are loaded before."""
    plan(1_000)
    begin = time.process_time()
    plan(blocks)
    return time.process_time() - begin


def read_and_rewrite(megabytes: float) -> None:
    """Print time and memory of reading a long program and writing some of its feeds."""
    blocks = int(1e6 * megabytes / BLOCK_BYTES)
    with tempfile.TemporaryFile() as file:
        file.writelines(f"{block}\n".encode() for block in raster(blocks))
        file.seek(0)
        data = file.read()
    print(f"{len(data) / 1e6:.0f} MB, {blocks} blocks; before reading {peak_mb():.0f} MB")
    with timed("read", blocks):
        program = read_program(data)
    some = range(10, len(program.text) - 10, REWRITTEN_SHARE)
    advice = (BlockAdvice(block=block, ends=(1.0,), feeds=(10.0,)) for block in some)
    with timed("rewrite", blocks):
        rewrite(program, advice)


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the times of 2000 and 10 000 blocks, or of what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("blocks", nargs="*", type=int)
    parser.add_argument("--file", type=float, metavar="MB")
    given = parser.parse_args(arguments)
    if given.file is not None:
        read_and_rewrite(given.file)
        return
    for blocks in given.blocks or (2_000, 10_000):
        plan(blocks)


if __name__ == "__main__":
    main()
