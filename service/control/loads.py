"""Reference loads: what a sharp tool has taught in each cut, kept in a file for the next runs.

The first run of a cut teaches its load, and later runs compare theirs with it. The file is
JSON, a load for each machine, material, tool and workingstep; it is read and written whole.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from math import exp, inf, isfinite
from pathlib import Path
from typing import Any, NamedTuple

from controller.record import RunRecord
from optimiser.advice import Advice
from service.files import read_bytes, write_atomically
from stepnc_model.errors import StepNcError

FEWEST = 20
"""Fewest revolutions from which a load is learnt."""

MOST_WEAR = 0.05
"""Greatest estimated flank wear of a tool that teaches, in mm."""

MOST_BYTES = 10_000_000
"""Largest file."""


class CutKey(NamedTuple):
    """Key of a reference load: tool and cut."""

    machine: str
    material: str
    tool: str
    workingstep: str


@dataclass(frozen=True, slots=True, kw_only=True)
class ReferenceLoad:
    """Load of a sharp tool in one cut."""

    force_n: float
    """Mean cutting force with chips."""
    power_w: float
    """Mean power of the main drive with chips."""
    kc_factor: float
    """Measured over expected force, by the catalogue's k_c."""
    revolutions: int
    """Number of revolutions that it was learnt from."""

    def __post_init__(self) -> None:
        for name in ("force_n", "kc_factor"):
            if not 0.0 < getattr(self, name) < inf:
                raise ValueError(f"{name} {getattr(self, name)!r} must be positive and finite")
        if not isfinite(self.power_w) or self.revolutions < 1:
            raise ValueError("power_w must be finite and revolutions at least 1")


Loads = Mapping[CutKey, ReferenceLoad]


def read_loads(path: Path | None) -> dict[CutKey, ReferenceLoad]:
    """Read the reference loads of a file; none if it does not exist yet.

    Raises
    ------
    StepNcError
        When the file is not one of reference loads; names the entry.
    """
    if path is None or not path.exists():
        return {}
    data = read_bytes(path)
    if len(data) > MOST_BYTES:
        raise StepNcError(f"{path}: {len(data)} bytes exceed {MOST_BYTES}: no reference loads")
    try:
        entries = json.loads(data)["reference_loads"]
    except (ValueError, KeyError, TypeError, RecursionError) as error:
        raise StepNcError(f"{path}: it holds no reference loads: {error}") from error
    if not isinstance(entries, list):
        raise StepNcError(f"{path}: reference_loads must be a list")
    return dict(_entry(path, number, entry) for number, entry in enumerate(entries, 1))


def _entry(path: Path, number: int, entry: Any) -> tuple[CutKey, ReferenceLoad]:
    try:
        names = [entry[name] for name in CutKey._fields]
        values = {field.name: entry[field.name] for field in fields(ReferenceLoad)}
        _require_types(names, list(values.values()))
        return CutKey(*names), ReferenceLoad(**values)
    except KeyError as error:
        raise StepNcError(f"{path}: reference load {number}: {error} is missing") from error
    except (TypeError, ValueError, OverflowError) as error:
        raise StepNcError(f"{path}: reference load {number}: {error}") from error


def _require_types(names: Sequence[Any], values: Sequence[Any]) -> None:
    """Refuse names that are no text and loads that are no numbers."""
    if not all(isinstance(name, str) for name in names):
        raise TypeError("machine, material, tool and workingstep must be text")
    is_number = (
        isinstance(each, int | float) and not isinstance(each, bool) for each in values
    )
    if not all(is_number):
        raise TypeError("loads must be numbers")


def write_loads(path: Path, loads: Loads) -> None:
    """Write reference loads, in the order of their keys; equal loads give equal bytes."""
    entries = [{**key._asdict(), **asdict(loads[key])} for key in sorted(loads)]
    text = json.dumps({"reference_loads": entries}, indent=1, ensure_ascii=False)
    write_atomically(path, f"{text}\n".encode())


def taught_load(record: RunRecord) -> ReferenceLoad | None:
    """Return the load that a cut has taught; None with a worn tool or too little to learn."""
    estimate, life = record.ratio, record.life
    if life is None or estimate.readings < FEWEST or life.flank_wear > MOST_WEAR:
        return None
    return ReferenceLoad(
        force_n=record.force,
        power_w=record.mean_power,
        kc_factor=exp(estimate.log_mean),
        revolutions=estimate.readings,
    )


def key_of(machine: str, material: str, advice: Advice) -> CutKey:
    """Return what the reference load of a workingstep belongs to."""
    return CutKey(machine, material, advice.tool.id, advice.workingstep.id)
