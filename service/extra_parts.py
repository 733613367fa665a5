"""Parts that extras add to the core, found by the names of their files.

An extra is a folder of ``extras``. The core imports none of them: it reads what each declares
in a module of a known name, such as ``ROUTES`` in ``rest``. Verbs of extras stand in their
folder ``verbs`` (:mod:`service.verbs.call`). A function of one extra that the core calls is a
port: its name is a constant of the caller, resolved at the call.
"""

from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

EXTRAS = Path(__file__).parents[1] / "extras"


def declared(module: str, name: str) -> Iterator[Any]:
    """Items that the extras declare under a name, in their module of this name.

    Parameters
    ----------
    module : str
        Module of an extra, such as ``rest``; many extras have none.
    name : str
        Name of a tuple in it; a module may lack it.
    """
    for file in sorted(EXTRAS.glob(f"*/{module}.py")):
        yield from getattr(import_module(f"extras.{file.parent.name}.{module}"), name, ())
