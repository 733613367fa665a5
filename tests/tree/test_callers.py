"""Every formula is one that the product calls: physics that only tests run proves nothing."""

import ast
from collections.abc import Iterator

from benchmarks.house import PRODUCT, ROOT

PHYSICS = "simulator.physics"

Name = tuple[str, str]
"""module and what it defines"""


def sources() -> dict[str, ast.Module]:
    """Modules of the product that speak of the physics, by their dotted names."""
    texts = {
        ".".join(path.relative_to(ROOT).with_suffix("").parts): path.read_text("utf-8")
        for package in (*PRODUCT, "benchmarks", "examples")
        for path in (ROOT / package).rglob("*.py")
    }
    return {
        module: ast.parse(text)
        for module, text in texts.items()
        if PHYSICS in text or module.startswith(PHYSICS)
    }


def defined(statement: ast.stmt) -> list[str]:
    """Names that a statement of a module makes."""
    if isinstance(statement, ast.FunctionDef | ast.ClassDef):
        return [statement.name]
    targets = statement.targets if isinstance(statement, ast.Assign) else []
    if isinstance(statement, ast.AnnAssign):
        targets = [statement.target]
    return [
        node.id for each in targets for node in ast.walk(each) if isinstance(node, ast.Name)
    ]


def imported(module: ast.Module) -> dict[str, Name]:
    """What a module calls the names that it imports, wherever in it."""
    return {
        alias.asname or alias.name: (node.module, alias.name)
        for node in ast.walk(module)
        if isinstance(node, ast.ImportFrom) and node.module
        for alias in node.names
    }


def read(statement: ast.stmt, module: str, known: dict[str, Name]) -> Iterator[Name]:
    """Names that a statement reads, by the modules which define them."""
    for node in ast.walk(statement):
        if isinstance(node, ast.Name):
            yield known.get(node.id, (module, node.id))
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            yield ".".join(known.get(node.value.id, ("", ""))), node.attr


def test_every_name_of_the_physics_is_called_by_the_product() -> None:
    readers: dict[Name, set[Name]] = {}
    called: set[Name] = set()
    for module, tree in sources().items():
        known = imported(tree)
        for statement in tree.body:
            names = set(read(statement, module, known))
            made = defined(statement) if module.startswith(PHYSICS) else []
            readers |= {(module, name): names for name in made}
            called |= set() if made else names
    waiting = list(called)
    while waiting:
        new = readers.get(waiting.pop(), set()) - called
        called |= new
        waiting += new
    assert sorted(set(readers) - called) == []
    assert len(readers) > 100
