"""Questions to the database and to the store of files, which may be slow to answer."""

import asyncio
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import Concatenate, ParamSpec, TypeVar

from starlette.concurrency import run_in_threadpool

from service.storage.folder import DataFolder

P = ParamSpec("P")
T = TypeVar("T")

ASKING = ThreadPoolExecutor(max_workers=8, thread_name_prefix="asking")
"""Threads that ask a server: as many as it has connections. All may wait; others go on."""


async def answered(
    function: Callable[Concatenate[DataFolder, P], T],
    data_folder: DataFolder,
    *arguments: P.args,
    **words: P.kwargs,
) -> T:
    """Ask the database; in a thread where it is a server, for which nobody else shall wait.

    A file answers at once, and a thread would take longer than its answer.
    """
    if not data_folder.database.is_shared:
        return function(data_folder, *arguments, **words)
    call = partial(function, data_folder, *arguments, **words)
    return await asyncio.get_running_loop().run_in_executor(ASKING, call)


async def result_file(data_folder: DataFolder, id: str, name: str) -> Path:
    """Return the path of a file that a job has written; from a store it is copied here."""
    if data_folder.store is None:
        return data_folder.job_folder(id) / name
    return await run_in_threadpool(_result_file, data_folder, id, name)


def _result_file(data_folder: DataFolder, id: str, name: str) -> Path:
    return data_folder.fetched(data_folder.job_folder(id) / name)
