"""Names and units of the nomenclature are those of the code."""

import ast
import re
from collections import Counter, defaultdict
from functools import cache
from itertools import pairwise

from benchmarks.house import ROOT
from tests.tree.sources import house

PAGE = ROOT / "docs" / "nomenclature.md"
NONE = "–"


def rows() -> list[tuple[str, str, str, str, str]]:
    """Rows of the tables of quantities."""
    found = []
    for line in PAGE.read_text(encoding="utf-8").splitlines():
        cells = [each.strip() for each in line.strip("|").split("|")]
        if len(cells) == 5 and cells[0].startswith("`"):
            found.append((cells[0].strip("`"), cells[1], cells[2], cells[3], cells[4]))
    return found


@cache
def nodes() -> list[ast.AST]:
    """All of the code."""
    return [
        node
        for tree in house().trees.values()
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef | ast.ClassDef | ast.Constant)
    ]


def text_of(statement: ast.stmt) -> str:
    """A docstring of a field; empty for another statement."""
    if isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant):
        return str(statement.value.value)
    return ""


@cache
def said() -> dict[str, list[str]]:
    """What docstrings say of each parameter and field; empty text where they say nothing."""
    found: defaultdict[str, list[str]] = defaultdict(list)
    for each in nodes():
        if isinstance(each, ast.FunctionDef):
            for argument in (*each.args.args, *each.args.kwonlyargs):
                found[argument.arg].append("")
        if isinstance(each, ast.ClassDef):
            for field, after in pairwise([*each.body, ast.Pass()]):
                if isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name):
                    found[field.target.id].append(text_of(after))
        if isinstance(each, ast.FunctionDef | ast.ClassDef):
            text = ast.get_docstring(each) or ""
            for names, kind in re.findall(r"^(\w+(?:, \w+)*) : (.*)$", text, flags=re.M):
                for name in names.split(", "):
                    found[name].append(kind)
    return found


@cache
def words() -> set[str]:
    """Names and texts of the code, and keys of the library's files."""
    found = set(said())
    for each in nodes():
        if isinstance(each, ast.Constant) and isinstance(each.value, str):
            found.add(each.value)
    for path in (ROOT / "simulator" / "data").rglob("*.toml"):
        found |= set(re.findall(r"^(\w+) =", path.read_text(encoding="utf-8"), flags=re.M))
    return found


def test_the_tables_are_read() -> None:
    assert len(rows()) >= 50


def test_names_are_parameters_or_fields() -> None:
    assert [row[0] for row in rows() if row[0] not in said()] == []


def test_docstrings_give_names_their_units() -> None:
    without = []
    for name, _, unit, _, _ in rows():
        pattern = re.compile(rf"(?<![\w/·']){re.escape(unit)}(?![\w/·²³])")
        if unit != NONE and not any(pattern.search(text) for text in said()[name]):
            without.append((name, unit))
    assert without == []


def test_names_at_the_edge_exist_and_carry_the_unit() -> None:
    edges = [row[3] for row in rows() if "`" in row[3]]
    assert edges
    assert [edge for edge in edges if not names_of(edge) <= words()] == []
    assert [edge for edge in edges if not carries_unit(edge)] == []


def names_of(edge: str) -> set[str]:
    return set(re.findall(r"`([^`]+)`", edge))


def carries_unit(edge: str) -> bool:
    """Whether the first name of an edge ends with its unit."""
    unit, _, _ = edge.partition(":")
    plain = {"%": "percent", "degrees": "deg", "µm": "um", "N·m": "nm", "kg·m²": "kg_m2"}
    plain["N/µm"] = "n_um"
    spelt = plain.get(unit, unit.lower().replace("²", "2").replace("³", "3").replace("/", "_"))
    return edge.split("`")[1].endswith(f"_{spelt}")


def test_no_name_stands_twice() -> None:
    names = Counter(row[0] for row in rows())
    assert [name for name, count in names.items() if count > 1] == []


def test_classes_of_the_words_are_classes_of_the_code() -> None:
    words = PAGE.read_text(encoding="utf-8").split("## Words")[1].split("EXPRESS names")[0]
    named = set(re.findall(r"`([A-Z][A-Za-z]+)`", words))
    assert named
    assert named - set(house().classes()) == set()
