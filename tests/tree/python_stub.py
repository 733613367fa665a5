"""Types of the functions of ``stepnc``, from the declarations of the verbs.

``python -m tests.tree.python_stub`` writes ``stepnc/__init__.pyi`` anew. Type checkers and
editors cannot read declarations that are made into functions at run time.
"""

from collections.abc import Iterator
from dataclasses import MISSING
from datetime import datetime
from enum import StrEnum
from pathlib import Path
from typing import get_args, get_type_hints

from service.requests.fields import RequestField, fields_of
from service.verbs.call import Verb, verbs

STUB = Path(__file__).parents[2] / "stepnc" / "__init__.pyi"

HEAD = '''"""Functions of ``stepnc``, made by ``python -m tests.tree.python_stub``."""

from collections.abc import Iterable, Mapping
from datetime import datetime
from pathlib import Path
from typing import Literal

from service.verbs.result import Result as Result
from stepnc_model.errors import StepNcError as StepNcError
'''


def stub() -> str:
    """Return the text of the stub."""
    found = list(verbs().values())
    results = sorted(result for each in found for result in _results(each))
    lines = [f"from {module} import {name} as {name}" for module, name in results]
    return "\n".join([HEAD, *lines, "", *(line for each in found for line in _function(each))])


def _results(verb: Verb) -> list[tuple[str, str]]:
    """Modules and names of the types that a verb returns."""
    found = get_type_hints(verb.run)["return"]
    return [(each.__module__, each.__name__) for each in get_args(found) or (found,)]


def _function(verb: Verb) -> Iterator[str]:
    files, request = fields_of(verb.files), fields_of(verb.request)
    places = [each for each in (*files, *request) if each.is_word]
    yield f"def {verb.function}("
    for field in places:
        yield f"    {_argument(field)},"
    keywords = [field for field in (*files, *request) if field not in places]
    if keywords:
        yield "    *,"
    for field in keywords:
        yield f"    {_argument(field)},"
    returned = " | ".join(name for _, name in _results(verb))
    yield f") -> {returned}: ..."


def _argument(field: RequestField) -> str:
    default = "" if field.default is MISSING else " = ..."
    return f"{field.name}: {_type(field)}{default}"


def _type(field: RequestField) -> str:
    """Type that a caller may give."""
    one = _kind(field)
    if field.is_sequence:
        one = f"{one} | Iterable[{one}]"
    return f"{one} | None" if field.is_optional or field.default is None else one


def _kind(field: RequestField) -> str:
    kind = field.kind
    if kind is datetime:
        return "datetime | str"
    if field.about.use is not None:
        return "str | Path"
    if isinstance(kind, type) and issubclass(kind, StrEnum):
        return f"Literal[{', '.join(repr(each.value) for each in kind)}]"
    if isinstance(kind, type) and kind in {bool, int, float, str}:
        return kind.__name__ if kind is not str else "str | Path"
    return "Mapping[str, bool]" if "Mapping" in str(kind) else "str | Path"


if __name__ == "__main__":
    STUB.write_text(stub(), encoding="utf-8")
