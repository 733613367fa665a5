"""Shop files in TOML or JSON: machines, shifts, crews, buffers and products with their routes.

Paths of programs and machines are relative to the file. A file is refused with key, value and
bound before anything runs.
"""

import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from extras.factory.model.calendar import Calendar, calendar_of, moment
from extras.factory.model.distribution import constant, scattered
from extras.factory.model.shop import (
    Buffer,
    Crew,
    Product,
    RouteStep,
    Shop,
    ShopMachine,
    StateLoad,
)
from extras.factory.model.shop_tables import (
    BufferRow,
    CrewRow,
    MachineRow,
    ProductRow,
    ShopFile,
    ShopHandlingTable,
    distribution_of,
)
from extras.factory.model.states import HANDLING, MachineState
from simulator.errors import LibraryError, UnknownMachine
from simulator.files.toml_file import converted, parsed, read_text
from simulator.library import load_machine
from simulator.spec import Machine
from stepnc_model.units import seconds_from_hours, seconds_from_minutes


def read_shop(
    path: Path,
    *,
    changes: Mapping[str, object] | None = None,
    machine_named: Callable[[str], Machine] = load_machine,
) -> Shop:
    """Read a shop file.

    Parameters
    ----------
    path : Path
        ``.json``, or TOML.
    changes : mapping, optional
        Values by key, as ``product[1].batch``, in place of the file's.
    machine_named : callable
        Function from a name, or a path, to a machine.

    Raises
    ------
    LibraryError
        When the file cannot be read, or a value is missing, unknown or out of its range.
    """
    beside = path.parent

    def machine_near(word: str) -> Machine:
        file = beside / word
        return machine_named(str(file) if Path(word).suffix and file.is_file() else word)

    return shop_of(
        content_of(read_text(path), path),
        path,
        changes=changes,
        machine_named=machine_near,
        program_named=lambda word: str(beside / word),
    )


def shop_of(
    content: dict[str, Any],
    path: Path,
    *,
    changes: Mapping[str, object] | None = None,
    machine_named: Callable[[str], Machine],
    program_named: Callable[[str], str],
) -> Shop:
    """Shop of the content of a shop file.

    Parameters
    ----------
    content : dict
        As the parser gave it; changed in place.
    path : Path
        Name of the file, for messages.
    changes : mapping, optional
        As in :func:`read_shop`.
    machine_named : callable
        Function from the word of a row to a machine.
    program_named : callable
        Function from the word of a step to the path of its program.

    Raises
    ------
    LibraryError
        When a value is missing, unknown or out of its range.
    """
    for key, value in (changes or {}).items():
        _change(content, key, value, path)
    file = converted(content, ShopFile, path)
    calendars = {row.name: calendar_of(row.hours) for row in file.shift}
    machines = tuple(
        machine
        for row, each in enumerate(file.machine, start=1)
        for machine in _machines(each, calendars, path, row, machine_named)
    )
    buffers = {row.name: _buffer(row) for row in file.buffer}
    products = tuple(_product(row, file.groups, buffers, program_named) for row in file.product)
    _require_time(products, machines, path)
    return Shop(
        title=file.title or path.stem,
        machines=machines,
        products=products,
        buffers=tuple(buffers.values()),
        crews=tuple(_crew(row, file.groups, calendars) for row in file.crew),
        duration=seconds_from_hours(file.hours),
        warm_up=seconds_from_hours(file.warm_up_hours),
        start=moment(file.start),
    )


def _require_time(
    products: Sequence[Product], machines: Sequence[ShopMachine], path: Path
) -> None:
    """Refuse raw stock without end that is used up without time."""
    specs = {machine.name: machine for machine in machines}
    for row, product in enumerate(products, start=1):
        first = product.steps[0]
        if product.arrival is not None or product.batches is not None or first.load is None:
            continue
        for name in first.machines:
            times = [first.load.time, *(load.time for load in specs[name].handling.values())]
            if all(time.is_zero for time in times):
                raise LibraryError(
                    f"0 s on {name}, which has no set-up either: raw stock that never runs out "
                    "would be used up at once; expected a time, arrival_min or batches",
                    path=str(path),
                    key=f"product[{row}].step[1].time_s",
                )


def content_of(text: str, path: Path) -> dict[str, Any]:
    """Content of the text of a shop file, JSON or TOML by its suffix.

    Raises
    ------
    LibraryError
        When it cannot be parsed.
    """
    if path.suffix.lower() != ".json":
        return parsed(text, path)
    try:
        content = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise LibraryError(f"is not valid JSON: {error}", path=str(path)) from error
    if not isinstance(content, dict):
        raise LibraryError("is not a table", path=str(path))
    return content


def _change(content: Any, key: str, value: object, path: Path) -> None:
    """Set the value of a key such as ``machine[2].failure[1].every_h.mean``."""
    *steps, last = key.replace("]", "").replace("[", ".").split(".")
    place = content
    try:
        for step in steps:
            place = place[int(step) - 1] if isinstance(place, list) else place[step]
        if isinstance(place, list):
            place[int(last) - 1] = value
        else:
            place[last] = value
    except (KeyError, IndexError, ValueError, TypeError) as error:
        raise LibraryError(
            "is not in the file; rows count from 1, as product[1].batch",
            path=str(path), key=key,
        ) from error  # fmt: skip


def _machines(
    row: MachineRow,
    calendars: Mapping[str, Calendar],
    path: Path,
    number: int,
    machine_named: Callable[[str], Machine],
) -> Iterable[ShopMachine]:
    """Machines of a row."""
    machine = None
    if row.machine:
        try:
            machine = machine_named(row.machine)
        except UnknownMachine as error:
            key = f"machine[{number}].machine"
            raise LibraryError(str(error), path=str(path), key=key) from error
    usual = 0.0 if machine is None else machine.base_power
    for name in row.names:
        yield ShopMachine(
            name=name,
            machine=machine,
            handling=_handling(row.handling, machine),
            idle_power=usual if row.idle_power_w is None else row.idle_power_w,
            calendar=calendars.get(row.shift),
            failures=tuple(each.failure for each in row.failure),
            maintenance=tuple(each.maintenance for each in row.maintenance),
        )


def _handling(
    table: ShopHandlingTable, machine: Machine | None
) -> dict[MachineState, StateLoad]:
    """Times and powers of set-up and ejection: those of the shop, or of the machine file."""
    usual = None if machine is None else machine.handling
    loads = {}
    for state in HANDLING:
        word = state.value.replace("-", "").replace(" ", "_")
        own = None if usual is None else getattr(usual, word)
        time, power = getattr(table, f"{word}_s"), getattr(table, f"{word}_w")
        known = constant(0.0)
        if own is not None and usual is not None:
            known = scattered(own.time, usual.time_scatter)
        loads[state] = StateLoad(
            time=known if time is None else distribution_of(time),
            power=power if power is not None else own.power if own is not None else 0.0,
        )
    return loads


def _product(
    row: ProductRow,
    groups: Mapping[str, tuple[str, ...]],
    buffers: dict[str, Buffer],
    program_named: Callable[[str], str],
) -> Product:
    """Product; a step without a buffer gets an unlimited one of its own."""
    steps = []
    for at, step in enumerate(row.step, start=1):
        into = step.into
        if not into and at < len(row.step):
            into = f"{row.name} after step {at}"
            buffers[into] = Buffer(name=into)
        machines = [name for group in step.machines for name in groups[group]]
        load = None
        if step.time_s is not None:
            load = StateLoad(time=distribution_of(step.time_s), power=step.power_w)
        steps.append(
            RouteStep(
                machines=tuple(dict.fromkeys(machines)),
                program=program_named(step.program) if step.program else "",
                load=load,
                design=None if step.vary is None else step.vary.design,
                into=into,
                scrap=step.scrap,
            )
        )
    arrival = row.arrival_min
    return Product(
        name=row.name,
        material=row.material,
        batch=int(row.batch),
        batches=None if row.batches is None else int(row.batches),
        arrival=None
        if arrival is None
        else distribution_of(arrival).scaled(seconds_from_minutes(1.0)),
        steps=tuple(steps),
        priority=row.priority,
    )


def _crew(
    row: CrewRow, groups: Mapping[str, tuple[str, ...]], calendars: Mapping[str, Calendar]
) -> Crew:
    served = row.machines or tuple(groups)
    return Crew(
        name=row.name,
        members=int(row.members),
        tasks=frozenset(row.tasks),
        machines=frozenset(name for group in served for name in groups[group]),
        calendar=calendars.get(row.shift),
    )


def _buffer(row: BufferRow) -> Buffer:
    return Buffer(name=row.name, capacity=None if row.capacity is None else int(row.capacity))
