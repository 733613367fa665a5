"""Tool paths as JSON: every move with its units."""

import json
from pathlib import Path

import pytest

from service.paths.output import paths_json
from service.paths.toolpaths import tool_paths

PARTS = Path(__file__).parents[3] / "examples" / "parts"


def test_moves_keep_their_ends_types_and_arcs() -> None:
    paths = tool_paths(PARTS / "bracket.stpnc")
    found = json.loads(paths_json(paths))
    items = {item["id"]: item for item in found["items"]}
    contour = next(path for path in paths.paths if path.id == "FINISH CONTOUR")
    steps = items["FINISH CONTOUR"]["steps"]
    assert [tuple(step["end_mm"]) for step in steps] == [move.end for move in contour.moves]
    # Four corners of 90 degrees, run clockwise, between two quarter circles of the approach.
    turns = [step["arc"]["turn_deg"] for step in steps if "arc" in step]
    assert turns[1:-1] == [pytest.approx(-90.0)] * 4
    assert items["LOOK AT THE CLAMPING"]["function"] == "OPTIONAL_STOP"


def test_pauses_and_pitches_are_told() -> None:
    text = paths_json(tool_paths(PARTS / "shaft.stpnc"))
    steps = [step for item in json.loads(text)["items"] for step in item["steps"]]
    pitches = {
        step["feed"]["per_revolution_mm"]
        for step in steps
        if step.get("feed") and step["feed"]["is_synchronised"]
    }
    assert pitches == {2.0}
    drilled = json.loads(paths_json(tool_paths(PARTS / "bracket.stpnc")))
    dwells = [
        step["dwell_s"]
        for item in drilled["items"]
        for step in item.get("steps", [])
        if "dwell_s" in step
    ]
    assert dwells == [0.2, 0.2]
