"""Laws fitted to a table of cuts, and predictions of cuts that were not fitted."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import sqrt

import numpy as np

from extras.calibration.model.cut_laws import CutForceLaw, Law, LawKind, LifeLaw, RoughnessLaw
from extras.calibration.model.cut_table import CutRow
from extras.calibration.model.log_model import Posterior, learned, unmeasured
from simulator.errors import CalibrationError
from simulator.spec import CuttingMaterial, WorkMaterial
from stepnc_model.errors import Finding, Severity
from stepnc_model.units import m_min_from_speed

LEVEL = 0.9
"""Probability within printed intervals."""

FEWEST = 2
"""Rows without which no law is fitted."""

JUDGED = 3
"""Conditions from which a law is compared with simpler rules before it is written."""

MEASURED = ("cutting_force_n", "specific_cutting_force_n_mm2", "ra_um", "life_min", "time_min")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FittedLaw:
    """A law with the rows that it was fitted to; without rows the prior alone."""

    law: Law
    rows: tuple[CutRow, ...]
    posterior: Posterior


@dataclass(frozen=True, slots=True, kw_only=True)
class CutPrediction:
    """Predicted and measured value of one row."""

    quantity: LawKind
    row: CutRow
    predicted: float
    low: float
    high: float
    measured: float
    is_bound: bool
    """True if the measured value is only a lower bound."""
    baselines: Mapping[str, float]

    @property
    def is_inside(self) -> bool:
        """True if the measured value lies within the interval."""
        if self.is_bound:
            return self.measured <= self.high
        return self.low <= self.measured <= self.high


@dataclass(frozen=True, slots=True, kw_only=True)
class CutSkill:
    """Quality of the predictions of one quantity."""

    quantity: LawKind
    count: int
    error: float
    """Mean absolute relative error, as a factor less 1."""
    coverage: float
    baseline: str
    """Best of the simpler rules."""
    baseline_error: float
    is_worse: bool
    """True if the law is worse than the rule by more than the scatter of the difference."""

    @property
    def skill(self) -> float:
        """Share of the baseline's error that the law removes."""
        if self.baseline_error == 0.0:
            return 0.0
        return 1.0 - self.error / self.baseline_error


def rows_of(
    quantity: LawKind, rows: Sequence[CutRow], *, criterion: float, findings: list[Finding]
) -> tuple[CutRow, ...]:
    """Rows that serve a quantity; for tool life one row an edge.

    Parameters
    ----------
    quantity : LawKind
    rows : sequence of CutRow
    criterion : float, mm
        Flank wear at which an edge is worn out.
    findings : list of Finding
        Takes warnings of rows that have a measured value and lack what it needs.
    """
    if quantity is LawKind.LIFE:
        return tuple(_edges(rows, criterion, findings))
    return tuple(row for row in rows if _serves(quantity, row, findings))


def _serves(quantity: LawKind, row: CutRow, findings: list[Finding]) -> bool:
    if quantity is LawKind.FORCES:
        if row.number("specific_cutting_force_n_mm2") is not None:
            return _has(row, findings, "feed_mm")
        if row.number("cutting_force_n") is None:
            return False
        if not row.is_turned:
            text = "of milling is not used: give specific_cutting_force_n_mm2 at the feed"
            findings.append(_warning(row, "cutting_force_n", text))
            return False
        return _has(row, findings, "feed_mm")
    if row.number("ra_um") is None:
        return False
    return _has(row, findings, "feed_mm", "nose_radius_mm")


def _has(row: CutRow, findings: list[Finding], *columns: str) -> bool:
    missing = [name for name in columns if row.number(name) is None]
    if missing:
        findings.append(_warning(row, " and ".join(missing), "is empty: the row is not used"))
    return not missing


def _warning(row: CutRow, column: str, text: str) -> Finding:
    return Finding(severity=Severity.WARNING, message=text, attribute=column, line=row.line)


def _edges(
    rows: Sequence[CutRow], criterion: float, findings: list[Finding]
) -> Iterator[CutRow]:
    series: dict[tuple[str, ...], list[CutRow]] = {}
    for row in rows:
        if row.number("life_min") is not None:
            if _has(row, findings, "cutting_speed_m_min"):
                yield row
        elif row.number("time_min") is not None:
            names = ("cutting_speed_m_min", "feed_mm", "axial_depth_mm")
            named = row.word("edge")
            same = (named,) if named else (row.key, *(repr(row.number(n)) for n in names))
            series.setdefault(same, []).append(row)
    for edge in series.values():
        first = edge[0]
        name = first.word("edge") or f"of line {first.line}"
        read = sorted(
            (row.numbers["time_min"], row.numbers["flank_wear_mm"])
            for row in edge
            if row.number("flank_wear_mm") is not None
        )
        if len(read) < 2:
            text = f"edge {name} has one wear reading and tells no life: it is not used"
            findings.append(_warning(first, "flank_wear_mm", text))
        elif _has(first, findings, "cutting_speed_m_min"):
            yield _life_of(first, read, criterion)


def _life_of(first: CutRow, read: Sequence[tuple[float, float]], criterion: float) -> CutRow:
    """Row of an edge with its life by interpolation, or the time at which it stopped."""
    numbers = {k: v for k, v in first.numbers.items() if k != "flank_wear_mm"}
    before = (0.0, 0.0)
    for time, wear in read:
        if wear >= criterion:
            share = (criterion - before[1]) / (wear - before[1])
            life = max(before[0] + share * (time - before[0]), 1e-2)
            numbers.pop("time_min", None)
            return replace(first, numbers={**numbers, "life_min": life})
        before = (time, wear)
    return replace(first, numbers={**numbers, "time_min": read[-1][0]})


def law_of(
    quantity: LawKind,
    material: WorkMaterial,
    rows: Sequence[CutRow],
    *,
    edge: CuttingMaterial,
) -> Law:
    """Law of a quantity in a material, with levels for the keys of the rows.

    Raises
    ------
    CalibrationError
        When a material has no Taylor constants for tool life.
    """
    if quantity is LawKind.FORCES:
        keys = tuple(sorted({row.key for row in rows}))
        return CutForceLaw(
            material=material, keys=keys, is_turned=all(row.is_turned for row in rows)
        )
    if quantity is LawKind.ROUGHNESS:
        return RoughnessLaw(material=material)
    for window in material.windows:
        low, high = window.min_cutting_speed, window.max_cutting_speed
        if window.cutting_material is edge and window.taylor is not None and low and high:
            return LifeLaw(
                taylor=window.taylor, edge_material=edge.value,
                speed=m_min_from_speed(sqrt(low * high)),
            )  # fmt: skip
    raise CalibrationError(
        f"{material.name} has no [[tool_life]] and [[window]] of {edge.value}",
        column="life_min",
    )


def fitted_law(
    quantity: LawKind, material: WorkMaterial, rows: Sequence[CutRow], *, edge: CuttingMaterial
) -> FittedLaw:
    """Fit a law to rows; without rows the prior is returned."""
    law = law_of(quantity, material, rows, edge=edge)
    if not rows:
        return FittedLaw(law=law, rows=(), posterior=unmeasured(law.prior))
    posterior = learned(law.curve(rows), law.readings(rows), law.prior)
    return FittedLaw(law=law, rows=tuple(rows), posterior=posterior)


def predictions(fitted: FittedLaw, rows: Sequence[CutRow]) -> list[CutPrediction]:
    """Predict rows, each with its interval and the simpler rules beside it."""
    if not rows:
        return []
    law = fitted.law
    of_rows = law.curve(rows), law.extra(rows, fitted.rows)
    value, low, high = (np.exp(each) for each in fitted.posterior.interval(*of_rows, LEVEL))
    readings = law.readings(rows)
    measured = np.exp(readings.value)
    rules = {k: np.exp(v) for k, v in law.baselines(rows, fitted.rows).items()}
    return [
        CutPrediction(
            quantity=law.quantity,
            row=row,
            predicted=float(value[at]),
            low=float(low[at]),
            high=float(high[at]),
            measured=float(measured[at]),
            is_bound=bool(readings.is_bound[at]),
            baselines={name: float(each[at]) for name, each in rules.items()},
        )
        for at, row in enumerate(rows)
    ]


def left_out(
    quantity: LawKind, material: WorkMaterial, rows: Sequence[CutRow], *, edge: CuttingMaterial
) -> list[CutPrediction]:
    """Predict each condition from the others; repeated readings are left out together."""
    groups: dict[object, list[CutRow]] = {}
    for row in rows:
        groups.setdefault(_condition(row), []).append(row)
    found = []
    for same, group in groups.items():
        others = [row for row in rows if _condition(row) != same]
        found += predictions(fitted_law(quantity, material, others, edge=edge), group)
    return found


def _condition(row: CutRow) -> object:
    numbers = tuple((k, v) for k, v in row.numbers.items() if k not in MEASURED)
    return row.key, row.word("operation"), row.word("edge"), numbers


def skill_of(found: Sequence[CutPrediction]) -> CutSkill | None:
    """Quality of predictions of one quantity; None without a measured value."""
    known = [each for each in found if not each.is_bound]
    if not known:
        return None
    measured = np.log([each.measured for each in known])
    error = np.abs(np.log([each.predicted for each in known]) - measured)
    rules = {
        name: np.abs(np.log([each.baselines[name] for each in known]) - measured)
        for name in known[0].baselines
        if all(name in each.baselines for each in known)
    }
    name = min(rules, key=lambda each: float(rules[each].mean()))
    more = error - rules[name]
    doubt = float(more.std(ddof=1)) / sqrt(len(more)) if len(more) > 1 else 0.0
    return CutSkill(
        quantity=known[0].quantity,
        count=len(known),
        error=float(np.expm1(error.mean())),
        coverage=float(np.mean([each.is_inside for each in found])),
        baseline=name,
        baseline_error=float(np.expm1(rules[name].mean())),
        is_worse=len(known) >= JUDGED and float(more.mean()) > doubt,
    )
