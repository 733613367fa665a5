"""The page of files and its schemas follow the declarations, and take every file of ours."""

import json
import tomllib
from pathlib import Path

import jsonschema  # type: ignore[import-untyped]
import pytest

from docs.hooks.file_page import file_page, schemas

ROOT = Path(__file__).parents[2]
DATA = ROOT / "simulator" / "data"
FILES = {
    "machine": sorted((DATA / "machines").rglob("*.toml")),
    "material": sorted((DATA / "materials").rglob("*.toml")),
    "grade": sorted((DATA / "tools").glob("*.toml")),
    "tools": sorted((ROOT / "examples" / "tools").glob("*.toml")),
    "holding": sorted((ROOT / "examples" / "holding").glob("*.toml")),
    "shop": [ROOT / "examples" / "shops" / "line.toml"],
}


@pytest.mark.parametrize("kind", FILES)
def test_files_of_the_library_keep_their_schema(kind: str) -> None:
    validator = jsonschema.Draft202012Validator(json.loads(schemas()[f"{kind}.schema.json"]))
    assert FILES[kind]
    for path in FILES[kind]:
        faults = [
            each.message for each in validator.iter_errors(tomllib.loads(path.read_text()))
        ]
        assert faults == [], path


def test_a_schema_refuses_what_the_reader_refuses() -> None:
    content = tomllib.loads((DATA / "machines" / "vmc15.toml").read_text())
    validator = jsonschema.Draft202012Validator(json.loads(schemas()["machine.schema.json"]))
    assert not validator.is_valid(content | {"rapid_mm_min": 0.5})
    assert not validator.is_valid(content | {"rapid_mm": 8000})


def test_the_page_has_keys_with_range_unit_and_default() -> None:
    page = file_page()
    assert "| `rapid_mm_min` | 1 to 300000 mm/min | required |" in page
    assert "| `kind` | `chuck` | required |" in page
    assert "### `[[spindle.curve]]`" in page
