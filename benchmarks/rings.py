"""Order in which modules of tests look for a fault: by their imports of its module."""

import ast
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from benchmarks.house import PRODUCT

TEST = re.compile(r"tests/(?!tree/)(.*/)?test_\w+\.py")
"""modules of tests; those of the architecture read the sources without running them"""

QUICK, SLOW = "not slow", "slow"
"""tiers, as markers of pytest"""

Graph = Mapping[str, frozenset[str]]
"""files by their paths, and the files that each imports"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Stage:
    """Modules of tests that run together."""

    ring: int
    files: tuple[str, ...]
    marker: str


def imports(folder: Path) -> Graph:
    """Imports between the files of the product, the tests and the benchmarks."""
    texts = {
        str(path.relative_to(folder)): path.read_bytes()
        for package in (*PRODUCT, "tests", "benchmarks")
        for path in sorted((folder / package).rglob("*.py"))
    }
    return {
        path: frozenset({*_imported(text), *_fixtures(path)} & texts.keys())
        for path, text in texts.items()
    }


def _imported(text: bytes) -> Iterator[str]:
    """Paths that import statements may mean."""
    for node in ast.walk(ast.parse(text)):
        names: list[str] = []
        if isinstance(node, ast.ImportFrom) and node.module:
            names = [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)]
        elif isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        yield from (f"{name.replace('.', '/')}.py" for name in names)


def _fixtures(path: str) -> Iterator[str]:
    """Paths of the fixtures that pytest may load for a module of tests."""
    if TEST.fullmatch(path):
        yield from (str(folder / "conftest.py") for folder in Path(path).parents)


def distances(graph: Graph, path: str) -> dict[str, int]:
    """Number of imports by which files reach one, nearest first."""
    found = {path: 0}
    edge = {path}
    while edge:
        edge = {each for each, reads in graph.items() if reads & edge and each not in found}
        found |= dict.fromkeys(sorted(edge), max(found.values()) + 1)
    return found


def stages(graph: Graph, path: str) -> Iterator[Stage]:
    """Tests in the order in which they look for a fault of a module."""
    tests = {each for each in graph if TEST.fullmatch(each)}
    folder, name = Path("tests", path).parent, Path(path).name
    own = {str(folder / f"test_{name}")} & tests
    own = own or {each for each in tests if Path(each).parent == folder}
    # The module itself has doctests.
    yield Stage(ring=1, files=(path, *sorted(own)), marker=QUICK)
    if own:
        yield Stage(ring=1, files=tuple(sorted(own)), marker=SLOW)
    away = distances(graph, path)
    near = {each: away[each] for each in away if each in tests - own}
    # Beside the mirror, tests of the neighbours are the nearest.
    near |= {each: min(near[each], 2) for each in near if Path(each).parent == folder}
    for distance in sorted(set(near.values())):
        files = tuple(each for each in near if near[each] == distance)
        yield Stage(ring=min(distance, 2), files=files, marker=QUICK)
    rest = sorted(tests - own - away.keys())
    yield Stage(ring=3, files=(*rest, *PRODUCT), marker=QUICK)
    yield Stage(ring=4, files=tuple(sorted(tests - own)), marker=SLOW)
