"""Exports: what is read back is what was stored."""

import csv
import json
import tracemalloc
from collections.abc import Sequence
from dataclasses import replace
from datetime import datetime
from math import exp
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
import pytest

from kbe.rows import OUTCOME
from service.knowledge import verbs as knowledge
from service.knowledge.columns import OUTCOME_COLUMNS
from service.knowledge.review import review
from service.outputs.flat_file import Format, write_rows
from service.rendering.columns import file_columns, file_rows
from service.requests.knowledge import ReviewRequest
from service.verbs.kbe.export.request import ExportedContent, ExportFiles, ExportRequest
from service.verbs.kbe.export.run import run
from stepnc_model.outcome import EvaluatedQuantity, ProcessOutcome

HOSTILE = "=cmd|' /C calc'!A0,\"\n+1"


def export(
    kb: str, path: Path, what: ExportedContent = ExportedContent.OUTCOMES, **words: str
) -> int | None:
    """Number of rows that are exported to a file."""
    request = ExportRequest(what=what, **words)  # type: ignore[arg-type]
    return run(request, ExportFiles(kb=kb, output=path)).rows


def nouns(rows: Sequence[dict[str, Any]]) -> list[ProcessOutcome]:
    return [OUTCOME.noun([row[leaf.name] for leaf in OUTCOME.leaves]) for row in rows]


@pytest.fixture
def hard(kb: str, shop_outcomes: tuple[ProcessOutcome, ...]) -> list[ProcessOutcome]:
    """The shop's outcomes, with one of which little is known, and one of hard names."""
    last = shop_outcomes[-1]
    bare = replace(
        last, force_ratio=None, immersion=None, specific_force=None, force=EvaluatedQuantity(),
        strategy="", trace="", sequence=1,
    )  # fmt: skip
    evil = replace(
        last,
        program=HOSTILE,
        workingstep="Fräsen Ø18 🛠",
        force=EvaluatedQuantity(predicted=0.1 + 0.2, measured=5e-324),
        recorded_at=last.recorded_at.replace(microsecond=123457),
    )
    knowledge.record(kb, [bare, evil])
    return [*shop_outcomes, bare, evil]


def test_parquet_reads_back_equal(kb: str, hard: list[ProcessOutcome], tmp_path: Path) -> None:
    path = tmp_path / "outcomes.parquet"
    assert export(kb, path) == len(hard)
    assert nouns(pq.read_table(path).to_pylist()) == hard


def test_json_reads_back_equal(kb: str, hard: list[ProcessOutcome], tmp_path: Path) -> None:
    path = tmp_path / "outcomes.json"
    assert export(kb, path) == len(hard)
    rows = json.loads(path.read_text(encoding="utf-8"))
    for row in rows:
        row["recorded_at"] = datetime.fromisoformat(row["recorded_at"])
    assert nouns(rows) == hard


def test_csv_has_every_number_and_no_formula(
    kb: str, hard: list[ProcessOutcome], tmp_path: Path
) -> None:
    path = tmp_path / "outcomes.csv"
    export(kb, path)
    with path.open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(hard)
    assert rows[-1]["program"] == f"'{HOSTILE}"
    assert rows[-2]["force_predicted_n"] == ""
    for row, outcome in zip(rows, hard, strict=True):
        if outcome.force.measured is not None:
            assert float(row["force_measured_n"]) == outcome.force.measured


def test_filters_hold_for_exports(kb: str, tmp_path: Path) -> None:
    path = tmp_path / "run.json"
    assert export(kb, path, run="000002") == 6
    assert {row["run"] for row in json.loads(path.read_text(encoding="utf-8"))} == {"000002"}


def test_corrections_have_their_factor_and_last_decision(kb: str, tmp_path: Path) -> None:
    review(kb, ReviewRequest(tool="ENDMILL 18"))
    knowledge.accept(kb, [1], by="A. Smith")
    path = tmp_path / "corrections.parquet"
    assert export(kb, path, ExportedContent.CORRECTIONS) == 6
    first, second, *_ = pq.read_table(path).to_pylist()
    assert (first["standing"], first["decided_by"]) == ("accepted", "A. Smith")
    assert (second["standing"], second["decided_at"]) == ("proposed", None)
    assert first["factor"] == pytest.approx(exp(first["log_centre"]), rel=1e-12)
    assert first["factor_low"] < first["factor"] < first["factor_high"]


@pytest.mark.parametrize("form", [Format.JSON, Format.CSV])
def test_memory_does_not_grow_with_the_outcomes(
    form: Format, tmp_path: Path, shop_outcomes: tuple[ProcessOutcome, ...]
) -> None:
    def peak(times: int) -> int:
        stream = (each for _ in range(times) for each in shop_outcomes)
        path = tmp_path / f"{times}.{form}"
        tracemalloc.start()
        rows = file_rows(OUTCOME_COLUMNS, stream)
        write_rows(path, file_columns(OUTCOME_COLUMNS), rows, form=form)
        _, most = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        return most

    peak(1)
    assert peak(5) < 1.5 * peak(1) + 100_000
