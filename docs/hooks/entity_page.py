"""The page of the optimisation entities, from the EXPRESS schema and the classes beside it."""

import ast
import re
from collections.abc import Iterator, Mapping
from itertools import pairwise
from pathlib import Path

from docs.hooks.express.reader import read_schemas
from docs.hooks.express.schema import (
    AggregateType,
    AttributeType,
    EntityDefinition,
    EnumerationType,
    Schema,
    SelectType,
)
from docs.hooks.markdown import code, first_line, page, table

SCHEMA = "stepnc_model/schemas/optimisation.exp"
CLASSES = "stepnc_model/entities/optimisation.py"

ISO_UNITS = {
    "length_measure": "mm",
    "positive_length_measure": "mm",
    "plane_angle_measure": "degrees",
    "rot_speed_measure": "rev/s, signed",
    "speed_measure": "m/s",
    "time_measure": "s",
}
"""of the measures that the schema takes from ISO 14649-10, 4.2.1"""

INTRODUCTION = """Entities that this project adds to ISO 14649, schema `optimisation_schema`
(`stepnc_model/schemas/optimisation.exp`). Numbers in a file are in the units of ISO 14649-10,
4.2.1: mm, s, m/s, rev/s with a sign (negative for right-hand tools), degrees; besides them N,
kW, J, µm and N/mm². A machining operation refers to its optimum by one attribute after its own,
for the reason told in [decision 0002](../decisions/0002-where-a-record-hangs.md). The profile
`standard` writes the same numbers as parameters of ISO 14649 to which no instance refers, named
after their workingstep: NIST's interpreter stops at what machine functions refer to. A system
that saves such a file again may drop them. `stepnc convert` goes both ways."""


def entity_page(root: Path) -> str:
    """The whole page."""
    text = (root / SCHEMA).read_text(encoding="utf-8")
    (schema,) = read_schemas(text)
    documented = _documented(root / CLASSES)
    units = {**ISO_UNITS, **own_units(text)}
    parts = [INTRODUCTION]
    for name, entity in schema.entities.items():
        said = documented.get(_class_name(name), {})
        parts += [f"## {name}", _kind(entity), _remark_before(name, text) or said.get("", "")]
        parts += _attributes(entity, documented=said, units=units)
    parts += ["## Types", table(("type", "is", "unit"), _types(schema, units))]
    return page("Optimisation entities", parts)


def own_units(text: str) -> dict[str, str]:
    """Units of the schema's own measures, from the remark on their line."""
    found = re.findall(r"^TYPE (\w+) = REAL; +\(\* (.+?) \*\)$", text, flags=re.MULTILINE)
    return {
        name: unit.replace("mm2", "mm²").replace("micrometre", "µm") for name, unit in found
    }


def spelt(kind: AttributeType) -> str:
    """A type as EXPRESS writes it."""
    if isinstance(kind, AggregateType):
        return f"{kind.kind} [{kind.lower}:{kind.upper}] OF {spelt(kind.element)}"
    return kind.name


def _remark_before(entity: str, text: str) -> str:
    """The remark on the lines right above an entity, if there is one."""
    remark = rf"^\(\* ((?:(?!\*\)).)*?) \*\)\nENTITY {entity}\b"
    found = re.search(remark, text, flags=re.DOTALL | re.MULTILINE)
    return " ".join(found[1].split()) if found else ""


def _kind(entity: EntityDefinition) -> str:
    kind = "abstract " if entity.is_abstract else ""
    above = ", ".join(map(code, entity.supertypes))
    kind += f"subtype of {above}" if above else "entity"
    return f"{code(entity.name.upper())}, {kind}."


def _attributes(
    entity: EntityDefinition, *, documented: Mapping[str, str], units: Mapping[str, str]
) -> Iterator[str]:
    """Attributes and rules."""
    rows = []
    for each in entity.attributes:
        unit = units.get(_innermost(each.type), "")
        said = documented.get(each.name, "")
        meaning = f"{unit}; {said}"
        if said.startswith(unit) or unit.startswith(said):
            meaning = max(unit, said, key=len)
        kind = code(spelt(each.type)) + (", optional" if each.is_optional else "")
        rows.append((code(each.name), kind, meaning))
    if rows:
        yield table(("attribute", "type", "unit, meaning"), rows)
    rules = (*entity.where, *entity.unique)
    yield "\n".join(f"* {each.label}: {code(' '.join(each.text.split()))}" for each in rules)


def _innermost(kind: AttributeType) -> str:
    return _innermost(kind.element) if isinstance(kind, AggregateType) else kind.name


def _types(schema: Schema, units: Mapping[str, str]) -> Iterator[tuple[str, str, str]]:
    for name, each in schema.types.items():
        below = each.underlying
        if isinstance(below, EnumerationType):
            yield code(name), "one of " + ", ".join(code(item) for item in below.items), ""
        elif not isinstance(below, SelectType):
            rules = "".join(f", {code(rule.text)}" for rule in each.where)
            yield code(name), code(spelt(below)) + rules, units.get(name, "")


def _class_name(entity: str) -> str:
    return "".join(word.capitalize() for word in entity.split("_"))


def _documented(path: Path) -> dict[str, dict[str, str]]:
    """Docstrings by class and attribute; the class's own under the empty name."""
    found: dict[str, dict[str, str]] = {}
    for cls in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(cls, ast.ClassDef):
            found[cls.name] = {"": _meaning(first_line(ast.get_docstring(cls)))}
            for field, after in pairwise(cls.body):
                if (
                    isinstance(field, ast.AnnAssign)
                    and isinstance(field.target, ast.Name)
                    and isinstance(after, ast.Expr)
                    and isinstance(after.value, ast.Constant)
                ):
                    found[cls.name][field.target.id] = str(after.value.value)
    return found


def _meaning(summary: str) -> str:
    """Summary without the name of the entity, as a sentence."""
    _, _, meaning = summary.partition(": ")
    return meaning[:1].upper() + meaning[1:]
