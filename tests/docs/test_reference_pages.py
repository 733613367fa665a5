"""Every verb, every error and every entity of the optimisation schema is documented."""

import argparse
import ast
import re
from functools import cache
from importlib import import_module
from pathlib import Path

import pytest

from docs.hooks import command_page as command_module
from docs.hooks.command_page import EXIT_CODES, VARIABLES, command_page, commands, listed
from docs.hooks.decision_pages import decision_files, decision_page
from docs.hooks.entity_page import CLASSES, SCHEMA, entity_page
from docs.hooks.error_page import error_classes, error_page
from docs.hooks.express.reader import read_schemas
from docs.hooks.markdown import cell, code
from docs.hooks.rest_page import openapi_document, operations, rest_page
from service.cli import options
from service.cli.commands import parser
from stepnc_model.errors import Severity, StepNcError
from tests.docs.pages import DOCS, ROOT

PACKAGES = ("stepnc_model", "simulator", "optimiser", "controller", "kbe", "service")
OF_PROCESSES = {"STEPNC_SERVE"}
"""variables by which the service hands settings to processes of its own"""

COMMANDS = command_page()
ERRORS = error_page(ROOT)
ENTITIES = entity_page(ROOT)


def section(text: str, title: str) -> str:
    found = re.search(
        rf"^## {re.escape(title)}(?: \{{.*\}})?\n.*?(?=^## |\Z)", text, flags=re.S | re.M
    )
    assert found is not None, title
    return found[0]


def subclasses(cls: type[Exception]) -> set[str]:
    below = {each.__name__ for each in cls.__subclasses__()}
    return below.union(*(subclasses(each) for each in cls.__subclasses__()))


@pytest.mark.parametrize("command", list(commands(parser())), ids=lambda each: each.prog)
def test_every_command_and_option_is_documented(command: object) -> None:
    (each,) = (one for one in commands(parser()) if one.prog == getattr(command, "prog", ""))
    own = section(COMMANDS, each.prog)
    for action in each._actions:
        if isinstance(action, argparse._HelpAction | argparse._SubParsersAction):
            continue
        row = f"| {cell(code(listed(action)))} | "
        assert set(action.option_strings) <= set(re.findall(r"--?[\w-]+", row))
        told = re.search(re.escape(row) + r"(.*) \|$", own, flags=re.M)
        assert told is not None
        # A word without help is a file, and the command says what becomes of it.
        assert told[1].strip() or not action.option_strings, (each.prog, listed(action))
        for choice in action.choices or ():
            assert f"`{choice}`" in told[1]


def test_every_command_says_what_it_does() -> None:
    for each in commands(parser()):
        row = re.search(rf"^\| \[`{each.prog}`\]\(#[\w-]+\) \| (.+) \|$", COMMANDS, flags=re.M)
        assert row is not None, f"{each.prog} has no help"


def test_every_exit_code_is_documented() -> None:
    codes = {
        value
        for name, value in vars(options).items()
        if name.isupper() and isinstance(value, int)
    }
    assert codes <= set(EXIT_CODES)
    own = section(COMMANDS, "Exit codes")
    assert all(f"| {code} |" in own for code in EXIT_CODES)


def test_every_environment_variable_is_documented() -> None:
    """Those of the project by their beginning, others where the environment is read."""
    found = set(re.findall(r"\"(STEPNC_[A-Z_]+)\"", sources()))
    found |= set(re.findall(r"environ(?:\.get\(|\[)\"(\w+)\"", sources()))
    found |= set(re.findall(r"\"(\w+)\" (?:not )?in os\.environ", sources()))
    assert found - OF_PROCESSES == set(VARIABLES)
    assert all(f"`{name}`" in section(COMMANDS, "Environment") for name in VARIABLES)


def test_the_page_of_commands_says_nothing_by_hand() -> None:
    """No command is named in the module that makes the page, but for its introduction."""
    text = Path(command_module.__file__).read_text(encoding="utf-8")
    assert not re.search(r"stepnc (?:kbe|post|check|control|simulate)", text)


def test_every_error_is_documented() -> None:
    modules = {each.module for each in error_classes(ROOT)}
    for module in modules:
        import_module(module)
    names = subclasses(StepNcError) | {"StepNcError"}
    of_tests = {each for each in names if f"class {each}(" not in sources()}
    assert {each.name for each in error_classes(ROOT)} == names - of_tests
    assert all(f"| `{name}` |" in ERRORS for name in names - of_tests)


@cache
def sources() -> str:
    """All code of the packages."""
    return "\n".join(
        path.read_text(encoding="utf-8")
        for package in PACKAGES
        for path in (ROOT / package).rglob("*.py")
    )


def test_every_error_says_what_it_is() -> None:
    assert [each.name for each in error_classes(ROOT) if not each.what] == []


def test_the_tree_shows_branches_and_attributes() -> None:
    assert "├── Part21Error(line, column)" in ERRORS
    assert "│   └── PathError" in ERRORS
    assert "│   ├── Infeasible(limits, station)" in ERRORS


def test_every_severity_of_a_finding_is_documented() -> None:
    own = section(ERRORS, "Findings")
    assert all(f"| `{each.value}` |" in own for each in Severity)


def test_every_entity_and_attribute_of_the_schema_is_documented() -> None:
    (schema,) = read_schemas((ROOT / SCHEMA).read_text(encoding="utf-8"))
    assert len(schema.entities) >= 15
    for name, entity in schema.entities.items():
        own = section(ENTITIES, name)
        assert all(f"| `{each.name}` |" in own for each in entity.attributes)
    types = section(ENTITIES, "Types")
    assert all(f"| `{name}` |" in types for name in schema.types)


def test_numbers_of_entities_have_their_unit() -> None:
    own = section(ENTITIES, "predicted_values")
    assert "| `machining_time` | `time_measure` | s |" in own
    assert "| `motor_power` | `power_measure` | kW, greatest |" in own
    assert (
        "| `surface_roughness` | `roughness_measure`, optional | µm, arithmetic mean |" in own
    )


def test_entities_without_a_remark_take_the_docstring_of_their_class() -> None:
    tree = ast.parse((ROOT / CLASSES).read_text(encoding="utf-8"))
    classes = {each.name for each in tree.body if isinstance(each, ast.ClassDef)}
    assert "MachinePower" in classes
    assert "Power available at the main drive." in section(ENTITIES, "machine_power")


def test_every_decision_is_in_the_list() -> None:
    text = decision_page(DOCS)
    files = decision_files(DOCS)
    assert len(files) == len(list((DOCS / "decisions").glob("*.md")))
    for name in files:
        heading = (DOCS / name).read_text(encoding="utf-8").splitlines()[0]
        assert Path(name).name in text
        assert heading.split(" ", 2)[2] in text


def test_decisions_are_numbered_one_after_another() -> None:
    numbers = [int(Path(name).name[:4]) for name in decision_files(DOCS)]
    assert numbers == list(range(1, len(numbers) + 1))


def test_every_route_is_documented() -> None:
    """As soon as the service describes itself: ``service.rest.app.openapi``."""
    document = openapi_document()
    if document is None:
        return
    text = rest_page(document)
    for path, method, operation in operations(document):
        assert f"\n## {method.upper()} {path} {{#" in text
        assert operation.get("summary"), f"{method} {path} has no summary"
