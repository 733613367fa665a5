"""Data sets on a Dask cluster: the rows of one process, though a worker is killed."""

from collections.abc import Iterator
from concurrent.futures import Executor, Future
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pyarrow as pa

from benchmarks.cluster import DESIGN
from benchmarks.local_cluster import LocalCluster, running_cluster
from extras.factory.model.design_file import read_design
from extras.learning.dataset_folder import DatasetFolder, table_of
from extras.learning.dataset_run import dataset_source, make_dataset
from service.execution.cluster import cluster
from service.progress import silent

ROWS, PARTITION = 24, 6


class KillingExecutor(Executor):
    """Executor of a cluster that loses a worker when a number of tasks were submitted."""

    def __init__(self, executor: Executor, made: LocalCluster, left: int) -> None:
        self._executor, self._made, self._left = executor, made, left

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        self._left -= 1
        if self._left == 0:
            self._made.kill_worker()
        return self._executor.submit(fn, *args, **kwargs)


def test_rows_are_those_of_one_process_though_a_worker_is_killed(tmp_path: Path) -> None:
    design, folder = tmp_path / "design.toml", tmp_path / "data"
    design.write_text(DESIGN, encoding="utf-8")
    with running_cluster(tmp_path, 2) as made:

        @contextmanager
        def pools() -> Iterator[Executor]:
            with cluster(made.address, patience=60.0) as executor:
                yield KillingExecutor(executor, made, 3)

        result = make_dataset(
            design, folder, rows=ROWS, tell=silent, pools=pools, partition=PARTITION
        )
    assert result.made == ROWS
    found = pa.concat_tables(DatasetFolder(folder, PARTITION).tables(ROWS))
    source = dataset_source(read_design(design), design)
    assert found.equals(table_of(source.rows(0, ROWS)))
