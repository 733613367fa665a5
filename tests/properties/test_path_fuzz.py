"""Whatever a file says: finite paths and NC code, or an error of the project, and soon."""

import random
import re
from functools import partial
from math import isfinite
from pathlib import Path

import pytest

from stepnc_model.errors import SchemaError, StepNcError
from stepnc_model.part21.reader import Part21File
from stepnc_model.post.blocks import Cycles
from stepnc_model.post.dialect import Dialect
from stepnc_model.post.dialects import write
from stepnc_model.post.neutral import blocks_of
from stepnc_model.programs.program import Program
from stepnc_model.programs.program_listing import ProgramLine
from stepnc_model.toolpath.arc import length
from stepnc_model.toolpath.generate import generate
from stepnc_model.toolpath.path import Function, ToolPath

ROOT = Path(__file__).parents[2]
FILES = {
    path.name: path.read_text(encoding="latin-1")
    for path in sorted([
        *(ROOT / "examples" / "parts").glob("*.stpnc"),
        *(ROOT.parent / "shared" / "corpus" / "iso14649").glob("*.p21"),
    ])
}

NUMBER = re.compile(r"(?<![#\w'.])-?[0-9]+\.[0-9]*(?:E[-+]?[0-9]+)?")
REFERENCE = re.compile(r"#[0-9]+(?!\s*=)\b")
KEYWORD = re.compile(r"(?<==)[A-Z][A-Z_0-9]+")
ENUMERATION = re.compile(r"\.[A-Z_]+\.")
VALUES = (
    "0.", "-1.", "1.E9", "1.E-9", "$", "-0.", "1.E300", "1.E-300", "100.", "-1.E9", "3.",
    "*", "''", "()", "7", "#1", "#99999",
)  # fmt: skip

RUNS = 60
"""of one seed"""


def mutated(text: str, chance: random.Random) -> str:
    """A text with one to three of its values replaced, by another or by a rude one."""
    head, mark, body = text.partition("DATA;")
    for _ in range(chance.choice((1, 1, 1, 2, 3))):
        pattern = chance.choice((NUMBER, NUMBER, NUMBER, REFERENCE, REFERENCE, ENUMERATION))
        if chance.random() < 0.05:
            pattern = KEYWORD
        found = list(pattern.finditer(body))
        if not found:
            continue
        match = chance.choice(found)
        is_other = pattern is KEYWORD or chance.random() < 0.4
        new = chance.choice(found)[0] if is_other else chance.choice(VALUES)
        body = body[: match.start()] + new + body[match.end() :]
    return head + mark + body


def require_finite(items: list[ToolPath | Function]) -> None:
    """No tool path leads nowhere."""
    for item in items:
        if isinstance(item, ToolPath):
            assert all(isfinite(length(at, move)) for at, move in item.segments())
            arcs = [move.arc for move in item.moves if move.arc is not None]
            assert all(isfinite(number) for arc in arcs for number in (*arc.centre, arc.turn))


def post(program: Program, items: list[ToolPath | Function]) -> None:
    """NC code for every control, or a refusal in one line."""
    for control in Dialect:
        for cycles in Cycles:
            refusal = ""
            try:
                for line in write(blocks_of(program, items, name="P"), control, cycles=cycles):
                    assert line.isprintable()
                    assert not re.search(r"\b(nan|inf)\b", line)
            except StepNcError as error:
                refusal = str(error)
            assert "\n" not in refusal


def take(faults: list[SchemaError], _executable: ProgramLine, fault: SchemaError) -> None:
    """Keep the reason why something was left out."""
    faults.append(fault)


@pytest.mark.parametrize("seed", range(4))
def test_rude_values_make_finite_paths_or_errors_of_the_project(seed: int) -> None:
    for run in range(RUNS):
        chance = random.Random(1000 * seed + run)
        name = chance.choice(sorted(FILES))
        text = mutated(FILES[name], chance)
        faults: list[SchemaError] = []
        try:
            program = Program(Part21File.from_bytes(text.encode("latin-1"), name=name))
            items = list(generate(program, partial(take, faults)))
        except StepNcError:
            continue
        require_finite(items)
        post(program, items)
        assert all("\n" not in str(fault) for fault in faults)
