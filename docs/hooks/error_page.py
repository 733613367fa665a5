"""The page of the errors: the tree below ``StepNcError``, and how much a finding matters."""

import ast
import re
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from docs.hooks.markdown import block, code, first_line, page, table

PACKAGES = ("stepnc_model", "simulator", "optimiser", "controller", "kbe", "service", "extras")
ROOT_CLASS = "StepNcError"
SEVERITY = ("stepnc_model/errors.py", "Severity")

INTRODUCTION = """What goes wrong because of a file, a machine or a number is an error of one
tree, whose root a program can catch. Each carries what it is about as attributes beside its
message. A mistake in a call of the library is Python's own `ValueError` or `TypeError`, and
in no tree.

At the command line an error is one line on standard error, `error: …`, and an [exit
code](commands.md#exit-codes): 4 for the branch of `OptimisationError`, 3 for all others."""

FINDINGS = """What is no failure is a *finding*: a deviation that was read all the same, a
default that was taken, a limit that was passed. It names the instance and its line, and has
one of these severities:"""


@dataclass(frozen=True, slots=True, kw_only=True)
class ErrorClass:
    """One class of the tree."""

    name: str
    base: str
    module: str
    what: str
    """first line of the docstring"""
    fields: tuple[str, ...]
    """attributes that it sets itself"""


def error_page(root: Path) -> str:
    """The whole page, from the packages below ``root``."""
    errors = error_classes(root)
    below = _by_base(errors)
    tree = [ROOT_CLASS, *_drawn(ROOT_CLASS, below, "")]
    rows = (
        (code(each.name), each.what, ", ".join(map(code, each.fields)), code(each.module))
        for each in errors
    )
    heads = ("error", "what it says", "attributes", "module")
    parts = [INTRODUCTION, block("\n".join(tree)), table(heads, rows)]
    parts += ["## Findings", FINDINGS, table(("severity", "meaning"), severities(root))]
    return page("Errors and findings", parts)


def error_classes(root: Path) -> tuple[ErrorClass, ...]:
    """Every class of the tree, each before those that are made of it."""
    found = {each.name: each for each in _classes(root)}
    below = _by_base(tuple(found.values()))
    return (found[ROOT_CLASS], *_descendants(ROOT_CLASS, below))


def severities(root: Path) -> list[tuple[str, str]]:
    """Words of ``Severity`` with their meaning."""
    file, name = SEVERITY
    tree = ast.parse((root / file).read_text(encoding="utf-8"))
    (body,) = (
        each.body for each in tree.body if isinstance(each, ast.ClassDef) and each.name == name
    )
    return [
        (code(str(word.value.value)), str(said.value.value))
        for word, said in pairwise(body)
        if isinstance(word, ast.Assign)
        and isinstance(word.value, ast.Constant)
        and isinstance(said, ast.Expr)
        and isinstance(said.value, ast.Constant)
    ]


def _classes(root: Path) -> Iterator[ErrorClass]:
    """All classes of the project that have one base with a name."""
    for path in sorted(path for package in PACKAGES for path in (root / package).rglob("*.py")):
        module = ".".join(path.relative_to(root).with_suffix("").parts)
        text = path.read_text(encoding="utf-8")
        # Most modules have no such class, and need not be parsed.
        for each in ast.parse(text).body if re.search(r"^class \w+\(", text, re.M) else ():
            if isinstance(each, ast.ClassDef) and each.bases:
                base = each.bases[0]
                yield ErrorClass(
                    name=each.name,
                    base=base.id if isinstance(base, ast.Name) else "",
                    module=module,
                    what=first_line(ast.get_docstring(each)),
                    fields=tuple(_fields(each)),
                )


def _fields(cls: ast.ClassDef) -> Iterator[str]:
    for each in ast.walk(cls):
        if (
            isinstance(each, ast.Attribute)
            and isinstance(each.ctx, ast.Store)
            and isinstance(each.value, ast.Name)
            and each.value.id == "self"
        ):
            yield each.attr


def _by_base(errors: Sequence[ErrorClass]) -> Mapping[str, list[ErrorClass]]:
    below: defaultdict[str, list[ErrorClass]] = defaultdict(list)
    for each in errors:
        below[each.base].append(each)
    for those in below.values():
        those.sort(key=lambda one: (PACKAGES.index(one.module.split(".")[0]), one.name))
    return below


def _descendants(name: str, below: Mapping[str, list[ErrorClass]]) -> Iterator[ErrorClass]:
    for each in below.get(name, ()):
        yield each
        yield from _descendants(each.name, below)


def _drawn(name: str, below: Mapping[str, list[ErrorClass]], before: str) -> Iterator[str]:
    those = below.get(name, [])
    for each in those:
        is_last = each is those[-1]
        own = f"({', '.join(each.fields)})" if each.fields else ""
        yield f"{before}{'└── ' if is_last else '├── '}{each.name}{own}"
        yield from _drawn(each.name, below, before + ("    " if is_last else "│   "))
