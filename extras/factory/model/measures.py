"""Figures of a shop: what each is called, its unit, and its interval over replications.

References
----------
.. [1] ISO 22400-2:2014, key performance indicators for manufacturing operations: availability,
   effectiveness, quality ratio and OEE index.
.. [2] A. M. Law, "Simulation Modeling and Analysis", ch. 9: intervals over independent
   replications by Student's t.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from math import inf, isnan, nan, sqrt
from statistics import mean, stdev


class Level(StrEnum):
    """Level of a shop to which a figure belongs."""

    LINE = "line"
    PRODUCT = "product"
    MACHINE = "machine"
    PROCESS = "process"
    """Machining of a product's step on a machine."""
    BUFFER = "buffer"


class Quantity(StrEnum):
    """Figure of a shop; the value names it with its unit."""

    THROUGHPUT = "good parts/h"
    PARTS = "parts"
    GOOD = "good parts"
    SCRAP = "scrap %"
    LEAD_TIME = "lead time h"
    WIP = "parts in the shop"
    LEVEL = "batches"
    UTILISATION = "machining %"
    AVAILABILITY = "availability %"
    EFFECTIVENESS = "effectiveness %"
    QUALITY = "quality %"
    OEE = "OEE %"
    STARVED = "starved %"
    BLOCKED = "blocked %"
    DOWN = "down %"
    ENERGY = "energy kWh"
    ENERGY_PER_PART = "kWh a good part"
    MEAN_POWER = "mean kW"
    PEAK_POWER = "peak kW"
    DEMAND = "peak 15 min kW"
    MINUTE_PEAK = "peak 1 min kW"
    TIME = "machining s"
    PART_ENERGY = "energy kJ"


@dataclass(frozen=True, slots=True, kw_only=True)
class Measure:
    """Figure of one run."""

    level: Level
    name: str
    """Machine, product, process or buffer; empty for the line."""
    quantity: Quantity
    value: float
    """In the unit of the quantity; NaN where nothing was made."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasureInterval:
    """Figure over replications."""

    level: Level
    name: str
    quantity: Quantity
    mean: float
    half_width: float
    """Half-width of the interval; infinite for one replication."""
    count: int
    """Replications that have the figure."""


def over_replications(
    runs: Sequence[Sequence[Measure]], *, confidence: float = 0.95
) -> tuple[MeasureInterval, ...]:
    """Means of figures over replications, with Student's interval, [2]_.

    Parameters
    ----------
    runs : sequence
        Figures of each replication, of the same shop.
    confidence : float
    """
    values: dict[tuple[Level, str, Quantity], list[float]] = {}
    for run in runs:
        for each in run:
            found = values.setdefault((each.level, each.name, each.quantity), [])
            if not isnan(each.value):
                found.append(each.value)
    return tuple(
        MeasureInterval(
            level=level,
            name=name,
            quantity=quantity,
            mean=mean(found) if found else nan,
            half_width=half_width(found, confidence=confidence),
            count=len(found),
        )
        for (level, name, quantity), found in values.items()
    )


def half_width(values: Sequence[float], *, confidence: float) -> float:
    """Half-width of Student's interval of the mean of independent values."""
    if len(values) < 2:
        return inf
    from scipy.special import stdtrit  # noqa: PLC0415 (slow to import)

    quantile = float(stdtrit(len(values) - 1, 0.5 + 0.5 * confidence))
    return quantile * stdev(values) / sqrt(len(values))
