"""Functions of ``stepnc``, made by ``python -m tests.tree.python_stub``."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Literal

from service.verbs.result import Result as Result
from stepnc_model.errors import StepNcError as StepNcError

from service.verbs.canonical.result import CanonicalResult as CanonicalResult
from service.verbs.check.result import CodeContents as CodeContents
from service.verbs.check.result import ProgramContents as ProgramContents
from service.verbs.convert.result import ConvertResult as ConvertResult
from service.verbs.cycletime.result import CycleTimeResult as CycleTimeResult
from service.verbs.library import EntryResult as EntryResult
from service.verbs.library import EntryResult as EntryResult
from service.verbs.library import ListingResult as ListingResult
from service.verbs.library import ListingResult as ListingResult
from service.verbs.post.result import PostResult as PostResult
from service.verbs.toolpath.result import CodePathResult as CodePathResult
from service.verbs.toolpath.result import ToolPathResult as ToolPathResult

def canonical(
    file: str | Path,
    *,
    units: Literal['iso', 'rpm-mmin', 'rpm-mmtooth', 'rpm-mmrev', 'revs-mmtooth', 'revs-mmrev', 'rpm-mmtooth-mmrev', 'revs-mmtooth-mmrev', 'auto'] = ...,
    stock: str | Path | None = ...,
    given: str | Path | Iterable[str | Path] = ...,
    teeth: str | Path | Iterable[str | Path] = ...,
    feed: str | Path = ...,
    dialect: Literal['canonical', 'linuxcnc', 'fanuc', 'haas', 'sinumerik', 'heidenhain'] | None = ...,
    is_lathe: bool = ...,
    keep_going: bool = ...,
) -> CanonicalResult: ...
def check(
    file: str | Path,
    *,
    name: str | Path = ...,
    most_repeats: int | None = ...,
    units: Literal['iso', 'rpm-mmin', 'rpm-mmtooth', 'rpm-mmrev', 'revs-mmtooth', 'revs-mmrev', 'rpm-mmtooth-mmrev', 'revs-mmtooth-mmrev', 'auto'] = ...,
    stock: str | Path | None = ...,
    given: str | Path | Iterable[str | Path] = ...,
    teeth: str | Path | Iterable[str | Path] = ...,
    feed: str | Path = ...,
    dialect: Literal['canonical', 'linuxcnc', 'fanuc', 'haas', 'sinumerik', 'heidenhain'] | None = ...,
) -> ProgramContents | CodeContents: ...
def convert(
    file: str | Path,
    *,
    output: str | Path,
    to: Literal['iso14649', 'ap238'] | None = ...,
    profile: Literal['optimisation', 'standard'] | None = ...,
) -> ConvertResult: ...
def cycletime(
    file: str | Path,
    log: str | Path | None = ...,
    *,
    most_repeats: int | None = ...,
    output: str | Path | None = ...,
    report: str | Path | None = ...,
    units: Literal['iso', 'rpm-mmin', 'rpm-mmtooth', 'rpm-mmrev', 'revs-mmtooth', 'revs-mmrev', 'rpm-mmtooth-mmrev', 'revs-mmtooth-mmrev', 'auto'] = ...,
    stock: str | Path | None = ...,
    given: str | Path | Iterable[str | Path] = ...,
    teeth: str | Path | Iterable[str | Path] = ...,
    feed: str | Path = ...,
    machine: str | Path = ...,
    dialect: str | Path = ...,
    control: Literal['exact-stop', 'junction', 'fir'] = ...,
    deviation_mm: float = ...,
) -> CycleTimeResult: ...
def machines(
    name: str | Path | None = ...,
) -> ListingResult | EntryResult: ...
def materials(
    name: str | Path | None = ...,
) -> ListingResult | EntryResult: ...
def post(
    file: str | Path,
    *,
    output: str | Path | None = ...,
    units: Literal['iso', 'rpm-mmin', 'rpm-mmtooth', 'rpm-mmrev', 'revs-mmtooth', 'revs-mmrev', 'rpm-mmtooth-mmrev', 'revs-mmtooth-mmrev', 'auto'] = ...,
    stock: str | Path | None = ...,
    given: str | Path | Iterable[str | Path] = ...,
    teeth: str | Path | Iterable[str | Path] = ...,
    feed: str | Path = ...,
    control: Literal['canonical', 'linuxcnc', 'fanuc', 'haas', 'sinumerik', 'heidenhain'],
    cycles: bool = ...,
    exact_path: bool = ...,
    keep_going: bool = ...,
) -> PostResult: ...
def toolpath(
    file: str | Path,
    *,
    most_repeats: int | None = ...,
    plot: str | Path | None = ...,
    units: Literal['iso', 'rpm-mmin', 'rpm-mmtooth', 'rpm-mmrev', 'revs-mmtooth', 'revs-mmrev', 'rpm-mmtooth-mmrev', 'revs-mmtooth-mmrev', 'auto'] = ...,
    stock: str | Path | None = ...,
    given: str | Path | Iterable[str | Path] = ...,
    teeth: str | Path | Iterable[str | Path] = ...,
    feed: str | Path = ...,
    dialect: Literal['canonical', 'linuxcnc', 'fanuc', 'haas', 'sinumerik', 'heidenhain'] | None = ...,
    keep_going: bool = ...,
) -> ToolPathResult | CodePathResult: ...