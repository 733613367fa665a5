"""Figures of the source code itself: its size, shared names, and what nothing reaches.

``python -m benchmarks.house`` prints them for the product: the packages that are installed.
Reached is what the console scripts import and read, through module-level code and through the
bodies of functions and classes; a class counts as a whole. ``--check`` prints public functions
and classes without a reader and exits with 1 where one is not allowed below. Entered are the
modules that ``optimise paper002`` runs beyond their own level, running those of which it runs
a function; argument names are those of the parameters that take instances of the product's
classes: as many as classes would be one name for each thing.
"""

import argparse
import ast
import io
import subprocess
import sys
import tokenize
import tomllib
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from tempfile import TemporaryDirectory

from service.verbs.call import verbs as all_verbs

ROOT = Path(__file__).parents[1]

PAPER = ROOT / "examples" / "parts" / "paper002.stpnc"

PRODUCT = (
    "stepnc_model", "simulator", "optimiser", "controller", "kbe", "service", "extras",
    "stepnc",
)  # fmt: skip

ALLOWED = {
    "optimiser.feed_profile.profile.smooth_limit": "problems without jumps, by hand",
    "optimiser.feed_profile.profile.tangential_limit": "problems made by hand",
    "optimiser.feed_profile.profile_program.solver_profile": "judge in tests",
    "kbe.migrations.versions.0001_outcomes.upgrade": "Alembic calls it by this name",
    "kbe.migrations.versions.0002_identity.upgrade": "Alembic calls it by this name",
    "service.rest.app.application": "the application by itself, for tests and other servers",
    "service.rest.app.openapi": "the document by itself, for the pages",
    "simulator.machine.samples.Rotation": "codes of a column, for readers of samples",
    "simulator.machine.samples.TravelDirection": "codes of columns, for readers of samples",
    "extras.linuxcnc.bench.run_programs": "a real control, in tests and benchmarks",
    "extras.linuxcnc.component.set_point": "of the component that LinuxCNC runs",
    "extras.linuxcnc.component.LoopLine": "of the component that LinuxCNC runs",
    "extras.linuxcnc.component.Control": "of the component that LinuxCNC runs",
    "extras.linuxcnc.component.main": "LinuxCNC runs it as a HAL component",
    "extras.linuxcnc.session.main": "runs in that control's namespaces",
    "simulator.motion.segments.arc": "paths made by hand, beside lines",
    "stepnc_model.editing.writeback.records": "reads what is written, for scripts",
}
"""public names that nothing reaches, with the reason why they stay; 20 at most"""

ENTER = """
import sys
from collections import defaultdict
from enum import Enum
from inspect import CO_NEWLOCALS
part, output, *product = sys.argv[1:]
entered, running, names = set(), set(), defaultdict(set)
def is_ours(module):
    return module.partition(".")[0] in product
def see(frame, event, _):
    code, module = frame.f_code, frame.f_globals.get("__name__", "")
    if event != "call" or code.co_name == "<module>" or not is_ours(module):
        return
    entered.add(module)
    # Bodies of classes have no locals of their own; dataclasses make functions of text.
    if not code.co_flags & CO_NEWLOCALS or code.co_name == "__create_fn__":
        return
    running.add(module)
    if code.co_name.startswith("__"):
        return
    for name in code.co_varnames[: code.co_argcount + code.co_kwonlyargcount]:
        kind = type(frame.f_locals.get(name))
        is_value = name in {"self", ".0"} or issubclass(kind, Enum)
        if not is_value and is_ours(kind.__module__):
            names[kind].add(name)
from service.cli.main import optimise_main
sys.setprofile(see)
words = [part, "--mode", "TC", "--machine", "vmc15", "--material", "c45", "-o", output]
try:
    optimise_main(words)
except SystemExit:
    pass
sys.setprofile(None)
print(len(entered), len(running), len(names), sum(map(len, names.values())))
print(*sorted(running))
"""
"""program that counts the modules it enters, those of which a function runs, and the names of
parameters by the classes of what they hold"""

ENTITIES = "stepnc_model.entities"
"""read by their EXPRESS names, which no name in the source tells"""

MIGRATIONS = (
    ("kbe.migrations.env", ""),
    ("kbe.migrations.versions.0001_outcomes", ""),
    ("kbe.migrations.versions.0002_identity", ""),
)
"""found by their folder"""

EXTRAS = "extras"
"""what only some users need; the rest is the core"""

FOUND = ("jobs", "rest")
"""modules of extras that the core finds by their names"""

PYTHON = ("stepnc", "__getattr__")
"""makes every verb a function"""

Name = tuple[str, str]
"""a module and what it defines; the empty name is its module-level code"""

Definition = ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef


@dataclass(frozen=True, slots=True, kw_only=True)
class Unit:
    """A definition, or the other statements of a module."""

    lines: int
    reads: frozenset[Name]


class House:
    """The source code of some packages."""

    def __init__(self, root: Path, packages: tuple[str, ...]) -> None:
        self.root = root
        self.texts = {
            _dotted(path.relative_to(root)): path.read_text("utf-8")
            for package in packages
            for path in sorted((root / package).rglob("*.py"))
        }
        self.trees = {module: ast.parse(text) for module, text in self.texts.items()}

    def classes(self) -> Counter[str]:
        """Number of definitions of each class name."""
        return Counter(
            node.name
            for tree in self.trees.values()
            for node in ast.walk(tree)
            if isinstance(node, ast.ClassDef)
        )

    def logical_lines(self) -> int:
        """Statements' lines without comments and docstrings, and lines of scripts and pages."""
        python = sum(
            _logical_lines(text, self.trees[name]) for name, text in self.texts.items()
        )
        pages = (
            path
            for package in {module.split(".")[0] for module in self.texts}
            for path in (self.root / package).rglob("*")
            if path.suffix in {".js", ".html", ".css", ".jinja"}
        )
        return python + sum(_page_lines(path.read_text("utf-8")) for path in pages)

    @cached_property
    def units(self) -> dict[Name, Unit]:
        """Everything that is defined, with what it reads."""
        return dict(self._units())

    @cached_property
    def imports(self) -> dict[str, dict[str, Name]]:
        """Names that each module imports, wherever in it, and their origins."""
        return {
            module: {
                alias.asname or alias.name: (node.module, alias.name)
                for node in ast.walk(tree)
                if isinstance(node, ast.ImportFrom) and node.module
                for alias in node.names
            }
            for module, tree in self.trees.items()
        }

    def _units(self) -> Iterator[tuple[Name, Unit]]:
        for module, tree in self.trees.items():
            known = self.imports[module]
            rest: set[Name] = set()
            for node in tree.body:
                reads = frozenset(_read(node, module, known))
                if isinstance(node, Definition) and _is_reached_by_name(node, module):
                    lines = (node.end_lineno or node.lineno) - node.lineno + 1
                    yield (module, node.name), Unit(lines=lines, reads=reads)
                else:
                    rest |= reads
            yield (module, ""), Unit(lines=0, reads=frozenset(rest))

    def origin(self, name: Name) -> Name:
        """Definition of a name that may be re-exported."""
        module, what = name
        if f"{module}.{what}" in self.trees:
            return f"{module}.{what}", ""
        if module in self.trees and name not in self.units:
            source = self.imports[module].get(what)
            return self.origin(source) if source else (module, "")
        return name

    def reached(self, begin: list[Name]) -> set[Name]:
        """Everything that some names read, and what that reads."""
        found: set[Name] = set()
        waiting = begin
        while waiting:
            name = self.origin(waiting.pop())
            if name in found or name not in self.units:
                continue
            found.add(name)
            waiting += [*self.units[name].reads, (name[0], "")]
        return found


def entries(root: Path) -> list[Name]:
    """Console scripts of the project."""
    project = tomllib.loads((root / "pyproject.toml").read_text("utf-8"))["project"]
    scripts = (script.partition(":") for script in project["scripts"].values())
    verbs = [
        (verb.module(module), item)
        for verb in all_verbs().values()
        for module, item in (("run", "run"), ("request", ""))
    ]
    parts = [
        (_dotted(file.relative_to(root)), "")
        for name in FOUND
        for file in sorted(root.glob(f"extras/*/{name}.py"))
    ]
    return [
        *((module, name) for module, _, name in scripts),
        *verbs,
        *parts,
        PYTHON,
        *MIGRATIONS,
    ]


def is_package(name: str) -> bool:
    """True if a dotted name is that of a folder."""
    return (ROOT / name.replace(".", "/")).is_dir()


def unreached(house: House, found: set[Name]) -> list[Name]:
    """Public names that are not among those, in their order."""
    return sorted(
        (module, name)
        for module, name in set(house.units) - found
        if name and not name.startswith("_")
    )


def _is_reached_by_name(node: Definition, module: str) -> bool:
    """True if a definition needs a reader: decorators register functions, keywords entities."""
    if isinstance(node, ast.ClassDef):
        return not module.startswith(ENTITIES)
    return not node.decorator_list


def _dotted(path: Path) -> str:
    parts = path.with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def _read(node: ast.stmt, module: str, known: dict[str, Name]) -> Iterator[Name]:
    """Names that a statement reads, by the modules which define them."""
    for each in ast.walk(node):
        if isinstance(each, ast.Name):
            yield known.get(each.id, (module, each.id))
        elif isinstance(each, ast.Attribute) and isinstance(each.value, ast.Name):
            yield ".".join(known.get(each.value.id, ("", ""))), each.attr
        elif isinstance(each, ast.ImportFrom) and each.module:
            yield each.module, ""
        elif isinstance(each, ast.Constant) and isinstance(each.value, str):
            module_named, _, what = each.value.partition(":")  # loaded by its name
            yield module_named, what


def _dots(module: str) -> list[int]:
    return [at for at, sign in enumerate(module) if sign == "."]


def _logical_lines(text: str, tree: ast.Module) -> int:
    docstrings = sum(
        ast.get_docstring(node, clean=False) is not None
        for node in ast.walk(tree)
        if isinstance(node, Definition | ast.Module)
    )
    # A string below an attribute documents it.
    docstrings += sum(
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
        for owner in ast.walk(tree)
        if isinstance(owner, ast.Module | ast.ClassDef)
        for node in owner.body[1:]
    )
    tokens = tokenize.generate_tokens(io.StringIO(text).readline)
    return sum(token.type == tokenize.NEWLINE for token in tokens) - docstrings


def _page_lines(text: str) -> int:
    lines = (line.strip() for line in text.splitlines())
    return sum(bool(line) and not line.startswith(("//", "/*", "*", "<!--")) for line in lines)


@dataclass(frozen=True, slots=True, kw_only=True)
class Walk:
    """Modules that ``optimise`` of a part runs through."""

    entered: int
    """Modules that run any code but that of their own level, that of classes among it."""
    running: tuple[str, ...]
    """Modules of which a function runs."""
    classes: int
    """Classes of the product whose instances are arguments."""
    names: int
    """Names of the parameters that take them, each counted for each class."""


def walk(part: Path) -> Walk:
    """Optimise a part in a new process and count."""
    with TemporaryDirectory() as folder:
        made = subprocess.run(
            [sys.executable, "-c", ENTER, str(part), f"{folder}/x.stpnc", *PRODUCT],
            cwd=ROOT, check=True, capture_output=True, text=True,
        )  # fmt: skip
    *_, figures, running = made.stdout.splitlines()
    entered, _, classes, names = map(int, figures.split())
    return Walk(entered=entered, running=(*running.split(),), classes=classes, names=names)


def main(arguments: list[str] | None = None) -> int:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--check", action="store_true", help="only what nothing reaches")
    parser.add_argument("--running", action="store_true", help="only what a request runs")
    options = parser.parse_args(arguments)
    if options.running:
        print(*walk(PAPER).running, sep="\n")
        return 0
    house = House(ROOT, PRODUCT)
    found = house.reached(entries(ROOT))
    idle = unreached(house, found)
    if options.check:
        wrong = [name for name in map(".".join, idle) if name not in ALLOWED]
        for each in wrong:
            print(f"{each}: no command, route or job reaches it")
        return 1 if wrong or len(ALLOWED) > 20 else 0
    shared = {name: count for name, count in house.classes().items() if count > 1}
    modules = {module for module, name in found if name == ""}
    # A module brings its packages along.
    modules |= {module[:at] for module in modules for at in _dots(module)}
    print(f"lines            {sum(text.count(chr(10)) for text in house.texts.values())}")
    rooms = {room: House(ROOT, (room,)) for room in PRODUCT}
    lines_of = {room: part.logical_lines() for room, part in rooms.items()}
    print(f"logical lines    {sum(lines_of.values())}")
    print(f"    of the core  {sum(lines_of.values()) - lines_of[EXTRAS]}")
    for room, part in rooms.items():
        loose = sum(name.count(".") == 1 for name in part.texts if not is_package(name))
        print(f"    {room:13}{lines_of[room]}, {loose} loose modules")
    print(f"modules          {len(house.texts)}")
    packages = sum(map(is_package, house.texts))
    print(f"packages         {packages}")
    print(f"classes          {house.classes().total()}")
    print(f"shared names     {len(shared)}")
    way = walk(PAPER)
    print(f"entered modules  {way.entered}")
    print(f"running modules  {len(way.running)}")
    print(f"argument names   {way.names} of {way.classes} classes")
    outside = sorted(set(house.texts) - modules)
    lines = sum(house.texts[module].count("\n") for module in outside)
    lines += sum(house.units[name].lines for name in idle if name[0] in modules)
    print(f"unreached lines  {lines}, {len(outside)} modules and {len(idle)} public names")
    for module in outside:
        print(f"    {module}")
    for name in idle:
        if name[0] in modules:
            print(f"    {'.'.join(name)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
