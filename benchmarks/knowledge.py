"""The knowledge base: outcomes a second, and the table of a million of them.

The peer is sqlite3 itself with the same rows, the same synchronisation and no knowledge of
outcomes. ``python -m benchmarks.knowledge --outcomes 1000000``
"""

import argparse
import sqlite3
import tempfile
import time
from collections.abc import Callable, Sequence
from itertools import islice
from pathlib import Path

import pytest

from kbe.queries import EVERYTHING
from kbe.rows import outcome_row
from kbe.store import Store, open_store
from service.knowledge.evaluation_table import summary
from stepnc_model.outcome import ProcessOutcome
from tests.postgres import started_server
from tests.service.shop import outcomes

BATCH = 1000
SINGLES = 300
"""outcomes that are committed one by one"""


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--outcomes", type=int, default=1_000_000)
    options = parser.parse_args(arguments)
    few = list(outcomes(20 * BATCH))
    header = f"{'one a commit/s':>15}  {f'{BATCH} a commit/s':>15}"
    print(f"{'outcomes into':>22}  {header}")
    with tempfile.TemporaryDirectory() as folder:
        peer = _peer(Path(folder) / "peer.db", few)
        _told("sqlite3 itself", peer, peer)
        with open_store(str(Path(folder) / "store.db")) as store:
            _told("SQLite", _rates(store.add, few), peer)
        _postgres(few, peer)
        _table(str(Path(folder) / "many.db"), options.outcomes)


def _rates(
    add: Callable[[Sequence[ProcessOutcome]], object], few: list[ProcessOutcome]
) -> tuple[float, float]:
    """Outcomes a second, one and many at once."""
    begin = time.perf_counter()
    for each in few[:SINGLES]:
        add([each])
    middle = time.perf_counter()
    # Outcomes that are stored already would not be stored again.
    rest = few[SINGLES:]
    for batch in _batches(rest):
        add(batch)
    end = time.perf_counter()
    return SINGLES / (middle - begin), len(rest) / (end - middle)


def _batches(few: Sequence[ProcessOutcome]) -> list[Sequence[ProcessOutcome]]:
    return [few[first : first + BATCH] for first in range(0, len(few), BATCH)]


def _peer(path: Path, few: list[ProcessOutcome]) -> tuple[float, float]:
    """The same rows as plain numbers and texts."""
    rows = {id(each): [_plain(value) for value in outcome_row(each).values()] for each in few}
    width = len(next(iter(rows.values())))
    connection = sqlite3.connect(path)
    connection.execute("PRAGMA journal_mode=WAL")
    connection.execute("PRAGMA synchronous=FULL")
    connection.execute(f"CREATE TABLE outcome ({', '.join(f'c{row}' for row in range(width))})")
    insert = f"INSERT INTO outcome VALUES ({', '.join('?' * width)})"

    def add(batch: Sequence[ProcessOutcome]) -> None:
        with connection:
            connection.executemany(insert, [rows[id(each)] for each in batch])

    return _rates(add, few)


def _plain(value: object) -> object:
    is_plain = value is None or isinstance(value, (int, float, str))
    return value if is_plain else str(value)


def _told(name: str, rates: tuple[float, float], peer: tuple[float, float]) -> None:
    ratios = ", ".join(f"{mine / its:.2f}" for mine, its in zip(rates, peer, strict=True))
    print(f"{name:>22}  {rates[0]:15.0f}  {rates[1]:15.0f}  of sqlite3's: {ratios}")


def _postgres(few: list[ProcessOutcome], peer: tuple[float, float]) -> None:
    try:
        server = started_server()
    except pytest.skip.Exception as why:
        print(f"{'PostgreSQL':>22}  left out: {why}")
        return
    try:
        with open_store(server.url) as store:
            _told("PostgreSQL", _rates(store.add, few), peer)
    finally:
        server.stop("fast")


def _table(place: str, count: int) -> None:
    """The table of many outcomes, by context and kind of feature."""
    with open_store(place) as store:
        _fill(store, count)
    begin = time.perf_counter()
    rows = len(summary(place, EVERYTHING).groups)
    mine = time.perf_counter() - begin
    connection = sqlite3.connect(place)
    begin = time.perf_counter()
    connection.execute("SELECT count(force_measured_n) FROM outcome NOT INDEXED").fetchone()
    scan = time.perf_counter() - begin
    print(
        f"table of {count} outcomes: {rows} rows in {mine:.2f} s, "
        f"{mine / scan:.2f} of sqlite3 reading one column of all"
    )


def _fill(store: Store, count: int) -> None:
    made = outcomes(count)
    while batch := list(islice(made, BATCH)):
        store.add(batch)


if __name__ == "__main__":
    main()
