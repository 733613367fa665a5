"""Speed of data sets, and time and memory of learning from more rows than fit in memory.

Rows of a data set are runs of the virtual machine, of a square pocket on the mill of the 2018
paper, on one process and on two. The rows to learn from are made by a formula; each learning is
a process of its own, whose peak memory is told beside that of one that learns from few.
``python -m benchmarks.learning --rows 10000``
"""

import argparse
import json
import resource
import subprocess
import sys
import time
from concurrent.futures import Executor
from contextlib import AbstractContextManager
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pyarrow as pa
from pyarrow import parquet

import stepnc
from extras.learning.dataset_folder import SCHEMA
from extras.learning.dataset_run import make_dataset
from service.execution.executors import processes
from service.progress import silent

PARTS, ROWS = 300, 1_000_000
TEST = 10_000
GROUP = 50_000
"""Rows that are made and written at a time."""

DESIGN = """program = "{part}"
machine = "paper003"
feed_mm_s = [30, 90]
spindle_rad_s = [75.4, 226.2]
depth_mm = [2.5, 3.5]
deviation = true
"""


def pool_of(count: int) -> AbstractContextManager[Executor]:
    return processes(count)


def dataset_speed(parts: int, count: int) -> float:
    """Parts per second of a data set on some processes."""
    part = Path(__file__).parents[1] / "examples" / "parts" / "paper003_pocket.stpnc"
    with TemporaryDirectory() as folder:
        design = Path(folder) / "design.toml"
        design.write_text(DESIGN.format(part=part), encoding="utf-8")
        pools = partial(pool_of, count)
        begin = time.perf_counter()
        make_dataset(
            design, Path(folder) / "rows", rows=parts, tell=silent, pools=pools, partition=20
        )
        return parts / (time.perf_counter() - begin)


def table_of(count: int, rng: np.random.Generator) -> pa.Table:
    """Rows of a formula: idle power, a cut whose force falls with the chip, 1 % noise."""
    feed, speed, depth = rng.uniform((30, 75.4, 2.5), (90, 226.2, 3.5), (count, 3)).T
    exact = 600.0 + 2.0 * speed + 4.0 * feed * depth * (speed / feed) ** 0.25
    power = exact * (1.0 + 0.01 * rng.standard_normal(count))
    nothing = pa.nulls(count, pa.float64())
    columns = {
        "row": np.arange(1, count + 1),
        **{name: pa.array(["one"] * count) for name in ("part", "machine", "material")},
        "feed_mm_s": feed,
        "spindle_rad_s": speed,
        "depth_mm": depth,
        **dict.fromkeys(("tool_diameter_mm", "flank_wear_mm"), nothing),
        "time_s": 4_000.0 / feed,
        "energy_j": power * 4_000.0 / feed,
        "energy_exact_j": exact * 4_000.0 / feed,
        "total_power_w": power,
        "total_power_exact_w": exact,
        "cutting_power_w": exact - 600.0,
        "peak_power_w": 2.0 * exact,
    }
    return pa.table(columns, schema=SCHEMA)


def write_rows(path: Path, count: int) -> None:
    """Write rows of the formula."""
    rng = np.random.default_rng(1)
    with parquet.ParquetWriter(path, SCHEMA, compression="zstd") as writer:
        for first in range(0, count, GROUP):
            writer.write_table(table_of(min(GROUP, count - first), rng))


def learned_alone(path: Path, model: str, rows: int) -> dict[str, float]:
    """Time, peak memory and scores of learning in a process of its own."""
    command = [sys.executable, "-m", "benchmarks.learning", "--learn", str(path), model]
    out = subprocess.run([*command, str(rows)], check=True, capture_output=True, text=True)
    found: dict[str, float] = json.loads(out.stdout)
    return found


def learn_here(path: Path, model: str, rows: int) -> None:
    """Learn, and print time, peak memory and scores as JSON."""
    begin = time.perf_counter()
    result = stepnc.learn(path, model=model, train=rows, test=TEST)
    seconds = time.perf_counter() - begin
    r2, best = result.scored[0].scores.r2, result.ceiling
    print(json.dumps({
        "seconds": seconds,
        "memory": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0,
        "r2": 0.0 if r2 is None else r2.value,
        "ceiling": 0.0 if best is None else best.value,
    }))  # fmt: skip


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--parts", type=int, default=PARTS)
    parser.add_argument("--rows", type=int, default=ROWS)
    parser.add_argument("--learn", nargs=3, metavar=("PATH", "MODEL", "ROWS"))
    options = parser.parse_args(arguments)
    if options.learn:
        path, model, rows = options.learn
        learn_here(Path(path), model, int(rows))
        return
    speeds = [dataset_speed(options.parts, count) for count in (1, 2)]
    print(
        f"data set of {options.parts} parts: {speeds[0]:.1f} parts/s on 1 process, "
        f"{speeds[1]:.1f} parts/s on 2, {speeds[1] / speeds[0]:.2f} times"
    )
    with TemporaryDirectory() as folder:
        path = Path(folder) / "rows.parquet"
        write_rows(path, options.rows + TEST)
        size = path.stat().st_size / 1e6
        print(f"{options.rows + TEST} rows by a formula: {size:.0f} MB of Parquet")
        for model in ("power-law", "mlp"):
            for rows in (options.rows // 1000, options.rows // 10, options.rows):
                found = learned_alone(path, model, max(rows, 500))
                print(
                    f"{model:9} from {max(rows, 500)} rows: {found['seconds']:.1f} s, peak "
                    f"memory {found['memory']:.0f} MB, R² {found['r2']:.5f} (ceiling "
                    f"{found['ceiling']:.5f})"
                )


if __name__ == "__main__":
    main()
