"""Shops that clients of the service ask for: names instead of paths, and bounds.

A program is the id of an uploaded one or the name of a sample; of a path only its last part is
taken, and looked up. A machine is one of the library or of the shop. So no file of the server
is named by a client.

Where a shop comes from: a file, or content that a client of the service sent.

Comparison of values of keys of a shop file: all combinations of them.
"""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass, field, replace
from itertools import product
from pathlib import Path, PurePosixPath

import orjson

from extras.factory.model.measures import MeasureInterval
from extras.factory.model.shop import Counting, Shop
from extras.factory.model.shop_file import content_of, read_shop, shop_of
from extras.factory.requests import FactoryOrder, ShopTimes
from service.errors import NotFound, TooLarge, Unreadable
from service.ids import PATTERN
from service.inputs.program_kind import ProgramKind
from service.storage import programs
from service.storage.folder import DataFolder
from service.storage.library import machine_word
from simulator.files.toml_file import read_text
from simulator.library import load_machine
from simulator.spec import Machine
from stepnc_model.errors import StepNcError
from stepnc_model.units import hours_from_seconds, seconds_from_hours

Changes = Mapping[str, float | str]
"""Values by key of a shop file."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ShopSource:
    """Shop that can be read with changes."""

    name: str
    """Name of the file, for messages."""
    read: Callable[[Changes | None], Shop]
    programs: Mapping[str, str] = field(default_factory=dict)
    """Names of programs for display, by their path; known once the shop was read."""


def source_of_file(file: Path) -> ShopSource:
    """Shop of a file."""
    return ShopSource(name=file.name, read=lambda changes: read_shop(file, changes=changes))


def chosen_shop(source: ShopSource, times: ShopTimes, changes: Changes | None = None) -> Shop:
    """Read a shop with the times and changes of a request.

    Raises
    ------
    StepNcError
        When the shop or a change is invalid.
    """
    shop = source.read(changes)
    if times.hours is not None:
        shop = replace(shop, duration=seconds_from_hours(times.hours))
    if times.warm_up_hours is not None:
        shop = replace(shop, warm_up=seconds_from_hours(times.warm_up_hours))
    if shop.warm_up >= shop.duration:
        raise StepNcError(
            f"{source.name}: warm-up {hours_from_seconds(shop.warm_up):g} h: it must be below "
            f"{hours_from_seconds(shop.duration):g} h, the whole time"
        )
    return shop


MOST = 1_000
"""Most combinations."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SweptKey:
    """Key of a shop file with the values to compare."""

    key: str
    values: tuple[float | str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class SweptCase:
    """Combination of values with the figures of its runs."""

    changes: tuple[tuple[str, float | str], ...]
    measures: tuple[MeasureInterval, ...]


def swept_keys(texts: Sequence[str]) -> tuple[SweptKey, ...]:
    """Keys and values of texts such as ``product[1].batch=1,5,10``.

    Raises
    ------
    StepNcError
        When a text has another form, or there are too many combinations.
    """
    keys = []
    count = 1
    for text in texts:
        key, sign, values = text.partition("=")
        words = [word.strip() for word in values.split(",") if word.strip()]
        if not sign or not key.strip() or not words:
            raise StepNcError(f"sweep '{text}': expected KEY=VALUE,VALUE")
        keys.append(SweptKey(key=key.strip(), values=tuple(_value(word) for word in words)))
        count *= len(words)
    if count > MOST:
        raise StepNcError(f"sweep: {count} combinations: at most {MOST}")
    return tuple(keys)


def combinations(keys: Sequence[SweptKey]) -> list[dict[str, float | str]]:
    """All combinations of the values of keys."""
    names = [each.key for each in keys]
    return [
        dict(zip(names, values, strict=True))
        for values in product(*(each.values for each in keys))
    ]


def _value(word: str) -> float | str:
    try:
        return float(word)
    except ValueError:
        return word


EXAMPLES = Path(__file__).parents[2] / "examples"
"""Folder of the sample shops and programs; an installed wheel has none."""

LARGEST = 1 << 16
"""Largest shop, in bytes."""

MOST_MACHINES = 200
MOST_STEPS = 100
MOST_RUNS = 60
"""Most programs times kinds of machines that run them."""

MOST_BATCH = 10_000
MOST_HOURS = 200_000.0
"""Most simulated hours of all replications and cases of a sweep together."""

MOST_PARTS = 2_000_000
"""Most parts that machines make, or that arrive, in one run."""

SHORTEST = 1.0
"""Shortest mean time between two failures or maintenances, s."""

_ID = re.compile(PATTERN)


def sample_shops() -> dict[str, Path]:
    """Files of the sample shops by name."""
    return {file.stem: file for file in sorted((EXAMPLES / "shops").glob("*.toml"))}


def source_of_order(data_folder: DataFolder, order: FactoryOrder) -> ShopSource:
    """Shop of an order.

    Raises
    ------
    Unreadable, NotFound, TooLarge
        When not exactly one shop is named, there is no such sample, or it is too large.
    """
    if (order.shop is None) == (not order.sample):
        raise Unreadable("name either a shop or a sample")
    if order.sample:
        file = sample_shops().get(order.sample)
        if file is None:
            raise NotFound("sample shop", order.sample)
        return _sample(file)
    if len(orjson.dumps(order.shop)) > LARGEST:
        raise TooLarge("a shop", bound=LARGEST)
    path = Path("shop.toml" if isinstance(order.shop, str) else "shop.json")
    content = content_of(order.shop, path) if isinstance(order.shop, str) else order.shop or {}
    names: dict[str, str] = {}

    def machine_named(word: str) -> Machine:
        return load_machine(machine_word(data_folder, word))

    def program_named(word: str) -> str:
        file, name = _program(data_folder, word)
        names[str(file)] = name
        return str(file)

    def read(changes: Changes | None) -> Shop:
        return shop_of(
            deepcopy(content),
            path,
            changes=changes,
            machine_named=machine_named,
            program_named=program_named,
        )

    return ShopSource(name="shop", read=read, programs=names)


def _sample(file: Path) -> ShopSource:
    """Sample shop; messages name its file without the folder."""
    path = Path(file.name)

    def read(changes: Changes | None) -> Shop:
        return shop_of(
            content_of(read_text(file), path),
            path,
            changes=changes,
            machine_named=load_machine,
            program_named=lambda word: str(file.parent / word),
        )

    return ShopSource(name=file.name, read=read)


def checked_shop(source: ShopSource, order: FactoryOrder) -> Shop:
    """Check an order before a job is queued, and return its shop.

    A live run counts from its beginning, unless the order has a warm-up.

    Raises
    ------
    StepNcError
        When the job would raise it, but for what only a run of the programs shows.
    """
    if order.pace and order.warm_up_hours is None:
        order = replace(order, warm_up_hours=0.0)
    shop = chosen_shop(source, order)
    require_small(shop)
    if order.pace and (order.replications > 1 or order.sweep):
        raise StepNcError("a live run has no replications and no sweep: leave them out")
    cases = len(combinations(keys)) if (keys := swept_keys(order.sweep)) else 0
    hours = hours_from_seconds(shop.duration) * order.replications * (1 + cases)
    if hours > MOST_HOURS:
        raise StepNcError(f"{hours:g} h of all runs: the service runs at most {MOST_HOURS:g} h")
    return shop


def require_small(shop: Shop) -> None:
    """Refuse a shop that would take too much memory or time.

    Raises
    ------
    StepNcError
        With the value and its bound.
    """
    steps = [step for product in shop.products for step in product.steps]
    batches = [(f"parts of a batch of {each.name}", each.batch) for each in shop.products]
    for what, value, bound in (
        ("machines", len(shop.machines), MOST_MACHINES),
        ("steps of all products", len(steps), MOST_STEPS),
        ("programs times kinds of machines", _runs(shop), MOST_RUNS),
        ("simulated hours", hours_from_seconds(shop.duration), MOST_HOURS),
        *((what, count, MOST_BATCH) for what, count in batches),
        *((f"parts of {name} that arrive", each, MOST_PARTS) for name, each in _arrivals(shop)),
    ):
        if value > bound:
            raise StepNcError(f"{value:g} {what}: the service runs at most {bound:g}")
    for machine in shop.machines:
        rows = [("failures", each.between.average) for each in machine.failures]
        rows += [
            ("maintenances", each.every)
            for each in machine.maintenance
            if each.counts is Counting.CLOCK
        ]
        for what, seconds in rows:
            if seconds < SHORTEST:
                where = f"machine '{machine.name}': {seconds:g} s between {what}"
                raise StepNcError(f"{where}: the service takes at least {SHORTEST:g} s")


def _runs(shop: Shop) -> int:
    """Programs times kinds of machines that run them."""
    kinds = {machine.name: machine.machine for machine in shop.machines}
    return len({
        (step.program, spec.name)
        for product in shop.products
        for step in product.steps
        if step.program
        for name in step.machines
        if (spec := kinds[name]) is not None
    })


def _arrivals(shop: Shop) -> Iterator[tuple[str, float]]:
    """Parts that arrive in a run, by product."""
    for each in shop.products:
        if each.arrival is not None:
            yield each.name, each.batch * shop.duration / each.arrival.average


def _program(data_folder: DataFolder, word: str) -> tuple[Path, str]:
    """File and name of a program that a client names.

    Raises
    ------
    NotFound
        When there is no such program.
    """
    if _ID.fullmatch(word):
        stored = programs.require_kind(data_folder, word, ProgramKind.STEP_NC)
        programs.require_file(data_folder, word)
        return data_folder.program_file(word), stored.name
    name = PurePosixPath(word.replace("\\", "/")).name
    samples = {file.name: file for file in (EXAMPLES / "parts").glob("*.stpnc")}
    file = samples.get(name) or samples.get(f"{name}.stpnc")
    if file is None:
        raise NotFound("program or sample", word[:100])
    return file, file.name
