"""A data set on a Dask cluster whose workers and whose client are killed, beside one process.

The scheduler and the workers are processes of this machine. Workers are killed (SIGKILL) at
random moments, each is replaced, and the client is killed once and started again.
``python -m benchmarks.cluster --rows 2000 --kills 8``
"""

import argparse
import os
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pyarrow as pa

from benchmarks.local_cluster import LocalCluster, end, running_cluster
from extras.learning.dataset_folder import PARTITION, DatasetFolder
from extras.learning.dataset_run import make_dataset
from service.execution.executors import processes
from service.progress import silent

ROWS, KILLS, WORKERS = 2000, 8, 3

PART = Path(__file__).parents[1] / "examples" / "parts" / "paper003_pocket.stpnc"

DESIGN = f"""program = "{PART}"
machine = "paper003"
feed_mm_s = [60, 90]
spindle_rad_s = [75.4, 226.2]
depth_mm = [2.5, 3.5]
deviation = true
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class KilledRun:
    """Data set on a cluster of which parts were killed."""

    table: pa.Table
    seconds: float
    clients: int
    """Number of clients that it took."""


def client(design: Path, folder: Path, rows: int, address: str) -> "subprocess.Popen[bytes]":
    """``stepnc dataset --cluster`` as a process of its own."""
    code = "from service.cli.main import main; main()"
    return subprocess.Popen(
        [sys.executable, "-c", code, "dataset", str(design), "-n", str(rows), "-o", str(folder),
         "--cluster", address],
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)},
    )  # fmt: skip


def whole(folder: Path, rows: int) -> pa.Table:
    """All rows of a data set."""
    return pa.concat_tables(DatasetFolder(folder, PARTITION).tables(rows))


def partitions(folder: Path) -> int:
    """Number of partitions that are there."""
    return len(list(folder.glob("*.parquet")))


def killed_run(
    design: Path, folder: Path, cluster: LocalCluster, rows: int, moments: Sequence[int]
) -> KilledRun:
    """Make a data set; at some numbers of partitions kill a worker, and once the client."""
    begin, clients = time.perf_counter(), 1
    running = client(design, folder, rows, cluster.address)
    left = sorted(moments)
    middle = left[len(left) // 2]
    try:
        while running.poll() is None:
            if left and partitions(folder) >= left[0]:
                cluster.start_worker()
                cluster.kill_worker()
                if left.pop(0) == middle:
                    end(running)
                    clients += 1
                    running = client(design, folder, rows, cluster.address)
            time.sleep(0.01)
    finally:
        end(running)
    if running.returncode:
        raise RuntimeError(f"the client ended with {running.returncode}")
    return KilledRun(
        table=whole(folder, rows), seconds=time.perf_counter() - begin, clients=clients
    )


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rows", type=int, default=ROWS)
    parser.add_argument("--kills", type=int, default=KILLS)
    parser.add_argument("--workers", type=int, default=WORKERS)
    options = parser.parse_args(arguments)
    with TemporaryDirectory() as name:
        home = Path(name)
        design = home / "design.toml"
        design.write_text(DESIGN, encoding="utf-8")
        begin = time.perf_counter()
        make_dataset(
            design, home / "one", rows=options.rows, tell=silent, pools=partial(processes, 1)
        )
        alone = time.perf_counter() - begin
        wanted = whole(home / "one", options.rows)
        print(
            f"one process: {options.rows} parts in {alone:.1f} s, "
            f"{1e3 * alone / options.rows:.1f} ms each"
        )
        moments = np.random.default_rng(4).choice(
            np.arange(1, options.rows // PARTITION), options.kills, replace=False
        )
        with running_cluster(home, options.workers) as made:
            found = killed_run(design, home / "cluster", made, options.rows, moments.tolist())
        rows = found.table.column("row").to_pylist()
        is_equal = "equal to" if found.table.equals(wanted) else "NOT"
        print(
            f"Dask, {options.workers} workers, {options.kills} killed, {found.clients} clients:"
            f" {len(set(rows))} of {options.rows} rows, {len(rows) - len(set(rows))} twice, "
            f"{is_equal} those of one process; "
            f"{found.seconds:.1f} s, {alone / found.seconds:.2f} of the speed of one process"
        )


if __name__ == "__main__":
    main()
