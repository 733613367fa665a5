"""Verbs by name: each is a folder beside this module.

A folder holds

- ``__init__.py``, whose docstring is the help: a sentence, then examples and details;
- ``request.py`` with ``REQUEST``, the type of the values that every door takes, and ``FILES``,
  that of the files that command line and Python name (``USUAL``: values that differ from those
  of REST where nothing is asked for);
- ``run.py`` with ``run(request, files, *, tell)``, which returns a
- :class:`~service.verbs.result.Result`, declared in ``result.py``.

A folder is all that a verb needs: doors find it by its name. In a name of two words, as
``kbe review``, the folder has an underscore.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from pathlib import Path
from types import ModuleType

from service.requests.fields import Request
from service.verbs.result import Result

HERE = Path(__file__).parent

GROUPS = frozenset({"kbe", "keys"})
"""First words of names of two words."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Verb:
    """A verb, whose parts are imported when they are needed."""

    folder: str

    @property
    def name(self) -> str:
        """Name on the command line, such as ``kbe review``."""
        first, _, rest = self.folder.partition("_")
        return f"{first} {rest}" if first in GROUPS else self.folder

    @property
    def about(self) -> str:
        """Help: a sentence, and details after an empty line."""
        return self._package.__doc__ or ""

    @property
    def line(self) -> str:
        """First sentence of the help, without its full stop."""
        return " ".join(self.about.partition("\n\n")[0].split()).removesuffix(".")

    @property
    def details(self) -> str:
        """The rest of the help; empty if there is none."""
        return self.about.partition("\n\n")[2].strip()

    @property
    def request(self) -> type[Request]:
        """Type of its request."""
        found: type[Request] = self._part("request").REQUEST
        return found

    @property
    def files(self) -> type[Request]:
        """Type of its files."""
        found: type[Request] = self._part("request").FILES
        return found

    @property
    def usual(self) -> Mapping[str, object]:
        """Values of the request that are usual on the command line and in Python."""
        found: Mapping[str, object] = getattr(self._part("request"), "USUAL", {})
        return found

    @property
    def run(self) -> Callable[..., Result]:
        """Function that does the work."""
        found: Callable[..., Result] = self._part("run").run
        return found

    @property
    def _package(self) -> ModuleType:
        return import_module(f"service.verbs.{self.folder}")

    def _part(self, name: str) -> ModuleType:
        return import_module(f"service.verbs.{self.folder}.{name}")


@cache
def verbs() -> dict[str, Verb]:
    """Return all verbs by the names of their folders, in alphabetical order."""
    folders = sorted(each.parent.name for each in HERE.glob("*/request.py"))
    return {name: Verb(folder=name) for name in folders}
