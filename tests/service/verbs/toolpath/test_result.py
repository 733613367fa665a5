"""Table, JSON and Arrow of ``toolpath`` add up to what the paths say."""

import json
from math import dist, pi
from pathlib import Path
from typing import Any

import pytest

import stepnc
from tests.service.verbs.toolpath.test_run import BRACKET, CODE, SHAFT, paths_of


def record(file: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(json.dumps(stepnc.toolpath(file).record()))
    return found


def test_lengths_of_a_drilled_hole_are_those_of_its_moves() -> None:
    """Only straight moves: contact, air and rapid add up to the whole way."""
    table = stepnc.toolpath(BRACKET).table()
    row = next(row for row in table.to_pylist() if row["workingstep"] == "DRILL HOLE 1")
    path = next(path for path in paths_of(BRACKET).paths if path.id == "DRILL HOLE 1")
    whole = sum(dist(start, move.end) for start, move in path.segments())
    assert (row["moves"], row["arcs"]) == (len(path.moves), 0)
    assert row["contact_mm"] + row["air_mm"] + row["rapid_mm"] == pytest.approx(whole)
    assert row["lowest_z_mm"] == pytest.approx(min(move.end[2] for move in path.moves))


def test_a_stop_has_a_row_of_its_own() -> None:
    assert "LOOK AT THE CLAMPING  optional_stop\n" in str(stepnc.toolpath(BRACKET))


def test_moves_keep_their_ends_types_and_arcs() -> None:
    items = {item["id"]: item for item in record(BRACKET)["items"]}
    contour = next(path for path in paths_of(BRACKET).paths if path.id == "FINISH CONTOUR")
    steps = items["FINISH CONTOUR"]["steps"]
    assert [tuple(step["end_mm"]) for step in steps] == [move.end for move in contour.moves]
    # Four corners of 90 degrees, run clockwise, between two quarter circles of the approach.
    turns = [step["arc"]["turn_deg"] for step in steps if "arc" in step]
    assert turns[1:-1] == [pytest.approx(-90.0)] * 4
    assert items["LOOK AT THE CLAMPING"]["function"] == "OPTIONAL_STOP"


def test_pauses_and_pitches_are_told() -> None:
    steps = [step for item in record(SHAFT)["items"] for step in item["steps"]]
    pitches = {
        step["feed"]["per_revolution_mm"]
        for step in steps
        if step.get("feed") and step["feed"]["is_synchronised"]
    }
    assert pitches == {2.0}
    drilled = [step for item in record(BRACKET)["items"] for step in item.get("steps", [])]
    assert [step["dwell_s"] for step in drilled if "dwell_s" in step] == [0.2, 0.2]


def test_code_has_a_row_for_each_tool_and_one_for_each_move(tmp_path: Path) -> None:
    code = tmp_path / "part.ngc"
    code.write_text(CODE)
    result = stepnc.toolpath(code)
    one, other = result.table("tools").to_pylist()
    assert (one["tool"], one["first_line"], one["moves"], one["arcs"]) == ("T1", 3, 3, 1)
    assert one["feed_mm"] == pytest.approx(6.0 + 10.0 * pi)
    assert one["unknown"] == 1
    assert (other["tool"], other["rapid_mm"], other["lowest_z_mm"]) == ("T2", 7.0, -3.0)
    moves = result.record()["moves"]
    assert [each["line"] for each in moves] == [3, 4, 5, 7, 8, 9]
    assert moves[2]["turn_deg"] == pytest.approx(-180.0)
    assert (moves[2]["centre_x_mm"], moves[2]["feed_mm_min"]) == (10.0, pytest.approx(100.0))
    assert [each["dwell_s"] for each in moves][-1] == 0.5
    assert "linuxcnc mill, 6 executed moves" in str(result)
