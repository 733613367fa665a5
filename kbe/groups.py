"""Statistics of outcomes, grouped by machine, material, tool and kind of feature.

They are the rows of an evaluation table, [1]_ "Knowledge-based evaluation", computed by the
database: for a million outcomes it scans one index. A variance from sums of squares loses about
as many digits as mean² over variance has; deviations are near zero, so enough digits remain.

References
----------
.. [1] F. Ridwan, X. Xu, G. Liu, "A framework for machining optimisation based on STEP-NC",
   J. Intell. Manuf., 2010.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from math import sqrt
from typing import Any

from sqlalchemy import ColumnElement, Select, func, select

from kbe.rows import EVALUATED
from kbe.schema import GROUP, outcome
from kbe.selection import Selection, conditions
from stepnc_model.outcome import Context


@dataclass(frozen=True, slots=True, kw_only=True)
class Spread:
    """Statistics of the deviations (measured over predicted, less one) of one quantity."""

    count: int
    """Number of outcomes in which the quantity was both predicted and measured."""
    mean: float | None
    """Mean deviation; None without outcomes."""
    deviation: float | None
    """Standard deviation of one outcome, with n − 1; None for fewer than two."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Group:
    """Statistics of the outcomes of one context and kind of feature."""

    context: Context
    feature_kind: str
    outcomes: int
    first: datetime
    last: datetime
    roughness: Spread
    time: Spread
    force: Spread
    feed: Spread


def grouped(selection: Selection) -> "Select[Any]":
    """Query of the grouped statistics, whose rows :func:`group` reads."""
    keys = [outcome.c[name] for name in GROUP]
    at = outcome.c.recorded_at
    sums = [each for name in EVALUATED for each in _sums(name)]
    return (
        select(*keys, func.count(), func.min(at), func.max(at), *sums)
        .where(*conditions(selection))
        .group_by(*keys)
    )


def _sums(name: str) -> tuple[ColumnElement[Any], ...]:
    """Count, sum and sum of squares of the deviations of a quantity."""
    deviation = outcome.c[f"{name}_deviation"]
    return func.count(deviation), func.sum(deviation), func.sum(deviation * deviation)


def group(row: Sequence[Any]) -> Group:
    """Convert a row of the query :func:`grouped` to a group."""
    machine, material, tool, kind, outcomes, first, last, *sums = row
    spreads = {
        name: spread(*sums[3 * index : 3 * index + 3]) for index, name in enumerate(EVALUATED)
    }
    context = Context(machine=machine, material=material, tool=tool)
    return Group(
        context=context,
        feature_kind=kind,
        outcomes=outcomes,
        first=first,
        last=last,
        **spreads,
    )


def spread(count: int, total: float | None, squares: float | None) -> Spread:
    """Mean and standard deviation from count, sum and sum of squares."""
    if not count or total is None or squares is None:
        return Spread(count=0, mean=None, deviation=None)
    mean = total / count
    if count == 1:
        return Spread(count=1, mean=mean, deviation=None)
    # Rounding may make it slightly negative.
    variance = max(squares - total * mean, 0.0) / (count - 1)
    return Spread(count=count, mean=mean, deviation=sqrt(variance))
