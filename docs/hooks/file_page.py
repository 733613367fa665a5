"""The page of the files that a user may write, and their JSON Schemas for editors.

Both follow from the declarations of :mod:`simulator.files.toml_file`.
"""

import json
from collections.abc import Iterator
from dataclasses import dataclass

import msgspec
from msgspec import inspect

from docs.hooks.markdown import code, first_line, page, table
from extras.factory.model.design_file import DesignTable
from extras.factory.model.shop_tables import ShopFile
from simulator.files.grade_file import GradeFile
from simulator.files.holding_file import HoldingFile
from simulator.files.machine_file import MachineFile
from simulator.files.material_file import MaterialFile
from simulator.files.toml_file import FileTable
from simulator.tools.tool_table import ToolFile

INTRODUCTION = """Machines, materials, tools, work-holding and shops are small TOML
files. A name that ends in `.toml` or has a slash is a file of yours, any other is one
of the library's, each of which is an example (`simulator/data`, `examples`). The unit
stands in the name of the key. A key that is unknown, missing or out of its range is
refused with the file, the key and the range.

An editor that knows JSON Schema completes and checks keys while you type: save the
schema of the kind beside your file, and begin the file with
`#:schema ./machine.schema.json`."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FileKind:
    """Kind of a file: where it is given, and the table that it is."""

    name: str
    given: str
    table: type[FileTable]


KINDS = (
    FileKind(name="machine", given="`--machine`", table=MachineFile),
    FileKind(name="material", given="`--material`", table=MaterialFile),
    FileKind(name="tools", given="`--tools`", table=ToolFile),
    FileKind(name="holding", given="`--holding`", table=HoldingFile),
    FileKind(name="grade", given="the library (`simulator/data/tools`)", table=GradeFile),
    FileKind(name="shop", given="`factory`", table=ShopFile),
    FileKind(name="design", given="`dataset`", table=DesignTable),
)


def file_page() -> str:
    """The whole page."""
    parts = [INTRODUCTION]
    for kind in KINDS:
        link = f"[{schema_name(kind)}]({schema_name(kind)})"
        parts.append(f"## {kind.name.capitalize()}\n\nGiven to {kind.given}. Schema: {link}")
        for place, struct in _tables(inspect.type_info(kind.table), ""):
            what = first_line(struct.cls.__doc__).replace("``", "`")
            parts += [f"### {place or 'The first keys'}", what]
            rows = [_row(field) for field in struct.fields if not _below(field.type)]
            if struct.tag is not None:
                rows.insert(0, (code(str(struct.tag_field)), code(str(struct.tag)), "required"))
            parts.append(table(("key", "value", "default"), rows))
    return page("Files", parts)


def schemas() -> dict[str, str]:
    """JSON Schemas by the name of their file."""
    return {
        schema_name(kind): json.dumps(msgspec.json.schema(kind.table), indent=1)
        for kind in KINDS
    }


def schema_name(kind: FileKind) -> str:
    """Name of the file of a schema."""
    return f"{kind.name}.schema.json"


def _tables(struct: inspect.Type, place: str) -> Iterator[tuple[str, inspect.StructType]]:
    """A table with its heading, then those below it."""
    assert isinstance(struct, inspect.StructType)
    yield place, struct
    for field in struct.fields:
        for each, is_row in _below(field.type):
            bare = f"{place.strip('`[]')}.{field.encode_name}".removeprefix(".")
            yield from _tables(each, f"`[[{bare}]]`" if is_row else f"`[{bare}]`")


def _below(kind: inspect.Type) -> list[tuple[inspect.StructType, bool]]:
    """Tables that a key holds, and whether it holds several of each."""
    match kind:
        case inspect.StructType():
            return [(kind, False)]
        case inspect.UnionType(types=types):
            return [each for part in types for each in _below(part)]
        case inspect.VarTupleType(item_type=item):
            return [(each, True) for each, _ in _below(item)]
        case inspect.DictType(value_type=value):
            return _below(value)
        case inspect.Metadata(type=inner):
            return _below(inner)
        case _:
            return []


def _row(field: inspect.Field) -> tuple[str, str, str]:
    """Row of a key: its name, what it takes, and its default."""
    default = "required" if field.required else _default(field.default)
    return code(field.encode_name), _value(field.type), default


def _default(value: object) -> str:
    """Default as it would be written; what means "none" is empty."""
    if value is None or value in {"", ()}:
        return ""
    return code(_number(value) if isinstance(value, float) else json.dumps(value))


def _value(kind: inspect.Type) -> str:
    """What a key takes, in words."""
    match kind:
        case inspect.Metadata(type=inner, extra=extra):
            unit = (extra or {}).get("unit", "")
            return f"{_value(inner)} {unit}".rstrip()
        case inspect.FloatType(ge=low, le=high) if low is not None and high is not None:
            return f"{_number(low)} to {_number(high)}"
        case inspect.IntType(ge=low, le=high) if low is not None and high is not None:
            return f"{_number(low)} to {_number(high)}"
        case inspect.FloatType() | inspect.IntType():
            return "a number"
        case inspect.StrType():
            return "text"
        case inspect.BoolType():
            return "`true` or `false`"
        case inspect.EnumType(cls=cls):
            return ", ".join(code(str(member.value)) for member in cls if member.value)
        case inspect.LiteralType(values=values):
            return ", ".join(code(str(value)) for value in values)
        case inspect.UnionType(types=types):
            found = [_value(each) for each in types if not isinstance(each, inspect.NoneType)]
            return " or ".join(found)
        case inspect.VarTupleType(item_type=item):
            return f"list of {_value(item)}"
        case inspect.DictType(value_type=value):
            return f"names with {_value(value)}"
        case _:
            raise TypeError(f"no words for {kind}")


def _number(value: float) -> str:
    """A number without an exponent."""
    return f"{value:.10f}".rstrip("0").rstrip(".")
