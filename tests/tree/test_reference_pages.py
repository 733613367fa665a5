"""Every verb, every error and every entity of the optimisation schema is documented."""

import argparse
import re
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path

from docs.hooks import command_page as command_module
from docs.hooks.command_page import EXIT_CODES, VARIABLES, command_page, commands, listed
from docs.hooks.decision_pages import decision_files, decision_page
from docs.hooks.entity_page import SCHEMA, entity_page
from docs.hooks.error_page import error_classes, error_page
from docs.hooks.express.reader import read_schemas
from docs.hooks.markdown import cell, code
from docs.hooks.rest_page import openapi_document, operations, rest_page
from service import errors as exit_codes
from service.cli.commands import parser
from stepnc_model.errors import Severity, StepNcError
from tests.docs.pages import DOCS, ROOT, section
from tests.tree.sources import house

OF_PROCESSES = {"STEPNC_SERVE"}
"""variables by which the service hands settings to processes of its own"""

COMMANDS = command_page()
ERRORS = error_page(ROOT)
ERROR_CLASSES = error_classes(ROOT)
ENTITIES = entity_page(ROOT)


def subclasses(cls: type[Exception]) -> set[str]:
    below = {each.__name__ for each in cls.__subclasses__()}
    return below.union(*(subclasses(each) for each in cls.__subclasses__()))


def undocumented(command: argparse.ArgumentParser) -> Iterator[str]:
    """Options and words of a command that the page does not explain, with all their choices."""
    own = section(COMMANDS, command.prog)
    for action in command._actions:
        if isinstance(action, argparse._HelpAction | argparse._SubParsersAction):
            continue
        row = f"| {cell(code(listed(action)))} | "
        found = re.search(re.escape(row) + r"(.*) \|$", own, flags=re.M)
        told = found[1] if found is not None else ""
        is_named = set(action.option_strings) <= set(re.findall(r"--?[\w-]+", row))
        # A word without help is a file, and the command says what becomes of it.
        is_told = found is not None and (told.strip() or not action.option_strings)
        choices = action.choices or ()
        if not (is_named and is_told and all(f"`{each}`" in told for each in choices)):
            yield f"{command.prog} {listed(action)}"


def test_commands_and_options_are_documented() -> None:
    assert [each for command in commands(parser()) for each in undocumented(command)] == []


def test_every_command_says_what_it_does() -> None:
    row = r"^\| \[`%s`\]\(#[\w-]+\) \| (.+) \|$"
    names = [each.prog for each in commands(parser())]
    assert [each for each in names if not re.search(row % each, COMMANDS, flags=re.M)] == []


def test_every_exit_code_is_documented() -> None:
    codes = {
        value
        for name, value in vars(exit_codes).items()
        if name.isupper() and isinstance(value, int)
    }
    assert codes - set(EXIT_CODES) == set()
    own = section(COMMANDS, "Exit codes")
    assert [each for each in EXIT_CODES if f"| {each} |" not in own] == []


def test_every_environment_variable_is_documented() -> None:
    """Those of the project by their beginning, others where the environment is read."""
    text = "\n".join(house().texts.values())
    found = set(re.findall(r"\"(STEPNC_[A-Z_]+)\"", text))
    found |= set(re.findall(r"environ(?:\.get\(|\[)\"(\w+)\"", text))
    found |= set(re.findall(r"\"(\w+)\" (?:not )?in os\.environ", text))
    assert found - OF_PROCESSES == set(VARIABLES)
    own = section(COMMANDS, "Environment")
    assert [name for name in VARIABLES if f"`{name}`" not in own] == []


def test_the_page_of_commands_says_nothing_by_hand() -> None:
    """No command is named in the module that makes the page, but for its introduction."""
    text = Path(command_module.__file__).read_text(encoding="utf-8")
    assert re.findall(r"stepnc (?:kbe|post|check|control|simulate)", text) == []


def test_every_error_is_documented() -> None:
    for module in {each.module for each in ERROR_CLASSES}:
        import_module(module)
    names = (subclasses(StepNcError) | {"StepNcError"}) & set(house().classes())
    assert {each.name for each in ERROR_CLASSES} == names
    assert [name for name in sorted(names) if f"| `{name}` |" not in ERRORS] == []


def test_every_error_says_what_it_is() -> None:
    assert [each.name for each in ERROR_CLASSES if not each.what] == []


def test_every_severity_of_a_finding_is_documented() -> None:
    own = section(ERRORS, "Findings")
    assert [each for each in Severity if f"| `{each.value}` |" not in own] == []


def test_entities_and_attributes_of_the_schema_are_documented() -> None:
    (schema,) = read_schemas((ROOT / SCHEMA).read_text(encoding="utf-8"))
    assert len(schema.entities) >= 15
    missing = [
        f"{name}.{attribute.name}"
        for name, entity in schema.entities.items()
        for attribute in entity.attributes
        if f"| `{attribute.name}` |" not in section(ENTITIES, name)
    ]
    assert missing == []
    types = section(ENTITIES, "Types")
    assert [name for name in schema.types if f"| `{name}` |" not in types] == []


def test_every_decision_is_in_the_list() -> None:
    text = decision_page(DOCS)
    files = decision_files(DOCS)
    assert len(files) == len(list((DOCS / "decisions").glob("*.md")))
    headings = {
        name: (DOCS / name).read_text(encoding="utf-8").splitlines()[0].split(" ", 2)[2]
        for name in files
    }
    missing = [
        name
        for name, heading in headings.items()
        if Path(name).name not in text or heading not in text
    ]
    assert missing == []


def test_decisions_are_numbered_one_after_another() -> None:
    numbers = [int(Path(name).name[:4]) for name in decision_files(DOCS)]
    assert numbers == list(range(1, len(numbers) + 1))


def test_every_route_is_documented() -> None:
    document = openapi_document()
    assert document is not None
    text = rest_page(document)
    missing = [
        f"{method} {path}"
        for path, method, operation in operations(document)
        if f"\n## {method.upper()} {path} {{#" not in text or not operation.get("summary")
    ]
    assert missing == []
