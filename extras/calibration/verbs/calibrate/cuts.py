"""Laws of a material from measured cuts, for ``calibrate --table`` and ``validate``."""

import hashlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Protocol

from extras.calibration.model.cut_fit import (
    FEWEST,
    JUDGED,
    LEVEL,
    CutPrediction,
    CutSkill,
    FittedLaw,
    fitted_law,
    left_out,
    predictions,
    rows_of,
    skill_of,
)
from extras.calibration.model.cut_laws import LawKind
from extras.calibration.model.cut_table import CutRow, CutTable, kept_rows, read_cut_table
from extras.calibration.model.material_text import calibrated_text, law_at_one, read_text
from service.errors import MissingArgument
from service.files import require_place, write_atomically
from service.programs.machine_choice import load_material_named
from service.progress import Tell
from service.rendering.columns import Column
from service.rendering.view import Fact, Findings, ResultView, Table, TextLine
from service.verbs.result import Result
from simulator.errors import CalibrationError
from simulator.files.material_file import CalibrationTable, MaterialFile, read_material
from simulator.files.toml_file import read_toml
from simulator.library import material_path
from simulator.spec import CuttingMaterial, Kienzle, Taylor, WorkMaterial
from stepnc_model.errors import Finding, Severity, StepNcError, WriteError
from stepnc_model.units import m_min_from_speed, speed_from_m_min

UNITS = {LawKind.FORCES: "N or N/mm²", LawKind.ROUGHNESS: "µm", LawKind.LIFE: "min"}

MOST_LISTED = 20
"""Rows with a reduced weight that are listed; the rest are counted."""


class CutChoice(Protocol):
    """Choices of a request that concern a table of cuts."""

    @property
    def material(self) -> str:
        """Name or path of the material."""

    @property
    def only(self) -> tuple[LawKind, ...]:
        """Quantities to learn; empty: all that the table holds."""

    @property
    def edge(self) -> CuttingMaterial:
        """Edge material of the tool lives."""

    @property
    def wear_criterion_mm(self) -> float:
        """Flank wear at which an edge is worn out."""


@dataclass(frozen=True, slots=True, kw_only=True)
class KnownMaterial:
    """A material as it was before any measurement, and the rows that its file keeps."""

    path: Path
    text: str
    start: WorkMaterial
    """Material with the constants from which the first fit started."""
    rows: tuple[CutRow, ...]
    kept: CalibrationTable | None


def known_material(request: CutChoice) -> KnownMaterial:
    """Load a material with what its file keeps of earlier fits.

    Raises
    ------
    StepNcError
        When none is named, its file is invalid, or the kept rows were changed.
    """
    if not request.material:
        raise MissingArgument("name the material of the cuts with --material")
    named = Path(request.material)
    found = load_material_named(request.material).material
    path = named if named.suffix == ".toml" else material_path(found.name)
    material = read_material(path)
    kept = read_toml(path, MaterialFile).calibration
    if kept is None:
        return KnownMaterial(
            path=path, text=read_text(path), start=material, rows=(), kept=None
        )
    if hashlib.sha256(kept.rows.encode()).hexdigest() != kept.digest:
        raise CalibrationError(
            "the kept rows do not have their digest: they were edited", path=str(path)
        )
    if kept.edge_material is not request.edge and kept.life is not None:
        raise CalibrationError(
            f"was calibrated with edges of {kept.edge_material.value}: name --edge",
            path=str(path),
        )
    return KnownMaterial(
        path=path, text=read_text(path), start=_before(material, kept),
        rows=kept_rows(kept.rows, str(path)), kept=kept,
    )  # fmt: skip


def _before(material: WorkMaterial, kept: CalibrationTable) -> WorkMaterial:
    """Material with the constants of before its calibration."""
    law = replace(material.kienzle, k_c11=kept.prior_k_c11_n_mm2, m_c=kept.prior_m_c)
    windows = material.windows
    if kept.prior_exponent is not None and kept.prior_constant_m_min is not None:
        taylor = Taylor(
            exponent=kept.prior_exponent, constant=speed_from_m_min(kept.prior_constant_m_min)
        )
        windows = tuple(
            replace(each, taylor=taylor)
            if each.cutting_material is kept.edge_material
            else each
            for each in windows
        )
    return replace(material, kienzle=law, windows=windows)


def quantities(request: CutChoice) -> tuple[LawKind, ...]:
    """Quantities that are asked for."""
    return request.only or tuple(LawKind)


def new_rows(table: CutTable, known: KnownMaterial) -> tuple[CutRow, ...]:
    """Rows of a table, unless the material's file already keeps all of them.

    Raises
    ------
    CalibrationError
        When the table was already used: its rows would count twice.
    """
    kept = {row.text for row in known.rows}
    fit = [row for row in table.rows if row.word("use") != "test"]
    if kept and fit and all(row.text in kept for row in fit):
        raise CalibrationError("the material was already calibrated with all its rows",
                               path=table.name)  # fmt: skip
    return table.rows


PREDICTED: tuple[Column[CutPrediction], ...] = (
    Column(key="quantity", heading="quantity", value=lambda each: each.quantity.value),
    Column(key="line", heading="line", form="d", value=lambda each: each.row.line or None),
    Column(heading="cut", value=lambda each: _cut(each.row)),
    Column(key="predicted", heading="predicted", form=".4g", value=lambda each: each.predicted),
    Column(key="low", heading="from", form=".4g", value=lambda each: each.low),
    Column(key="high", heading="to", form=".4g", value=lambda each: each.high),
    Column(key="measured", heading="measured", form=".4g", value=lambda each: each.measured),
    Column(key="is_bound", value=lambda each: each.is_bound),
    Column(
        key="error", heading="error", form="+.1%",
        value=lambda each: None if each.is_bound else each.predicted / each.measured - 1.0,
    ),
    Column(
        key="is_inside", heading="inside", value=lambda each: "yes" if each.is_inside else "no"
    ),
    Column(
        key="simpler_rules",
        heading="simpler rules",
        value=lambda each: ", ".join(f"{k} {v:.4g}" for k, v in each.baselines.items()),
    ),
)  # fmt: skip

SKILLS: tuple[Column[CutSkill], ...] = (
    Column(key="quantity", heading="quantity", value=lambda each: each.quantity.value),
    Column(key="count", heading="predicted", form="d", value=lambda each: each.count),
    Column(key="error", heading="mean error", form=".1%", value=lambda each: each.error),
    Column(
        key="coverage", heading=f"inside {LEVEL:.0%}", form=".0%",
        value=lambda each: each.coverage,
    ),
    Column(key="baseline", heading="best simpler rule", value=lambda each: each.baseline),
    Column(
        key="baseline_error", heading="its error", form=".1%",
        value=lambda each: each.baseline_error,
    ),
    Column(key="skill", heading="skill", form=".2f", value=lambda each: each.skill),
)  # fmt: skip


def _cut(row: CutRow) -> str:
    """Conditions of a row in a few words."""
    names = {
        "cutting_speed_m_min": "m/min", "feed_mm": "mm/rev" if row.is_turned else "mm/tooth",
        "axial_depth_mm": "mm deep",
    }  # fmt: skip
    words = [f"{row.numbers[name]:g} {unit}" for name, unit in names.items()
             if name in row.numbers]  # fmt: skip
    return "; ".join([*words, *([row.key] if row.key else [])])


@dataclass(frozen=True, slots=True, kw_only=True)
class ParameterLine:
    """One parameter of a law, with what the rows say of it."""

    quantity: LawKind
    name: str
    mean: float
    sd: float
    prior_mean: float
    prior_sd: float

    @property
    def learned(self) -> float:
        """Share of the prior's variance that the rows removed."""
        return 1.0 - (self.sd / self.prior_sd) ** 2


PARAMETERS: tuple[Column[ParameterLine], ...] = (
    Column(key="quantity", heading="quantity", value=lambda each: each.quantity.value),
    Column(key="parameter", heading="parameter", value=lambda each: each.name),
    Column(key="mean", heading="value", form=".4g", value=lambda each: each.mean),
    Column(key="sd", value=lambda each: each.sd),
    Column(
        heading="90 % interval",
        value=lambda each: (
            f"{each.mean - 1.645 * each.sd:.4g} to {each.mean + 1.645 * each.sd:.4g}"
        ),
    ),
    Column(heading="prior", value=lambda each: f"{each.prior_mean:.4g} ± {each.prior_sd:.4g}"),
    Column(key="prior_mean", value=lambda each: each.prior_mean),
    Column(key="prior_sd", value=lambda each: each.prior_sd),
    Column(key="learned", heading="seen", form=".0%", value=lambda each: each.learned),
    Column(
        heading="from prior",
        value=lambda each: f"{(each.mean - each.prior_mean) / each.prior_sd:+.1f} sd",
    ),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class CutsResult(Result):
    """Result of ``calibrate --table`` or ``validate``: laws, predictions and their quality."""

    material: WorkMaterial
    fits: tuple[FittedLaw, ...]
    predicted: tuple[CutPrediction, ...]
    how: str
    """How predictions were made, for people."""
    is_fit: bool
    """True if the laws are shown, as `calibrate` does."""
    findings: tuple[Finding, ...]

    @property
    def skills(self) -> tuple[CutSkill, ...]:
        """Quality by quantity."""
        return tuple(_skills(self.predicted))

    def view(self) -> ResultView:
        """Return parameters, predictions beside measurements, and their quality."""
        return ResultView([
            TextLine(text=f"material {self.material.name} ({self.material.title})"),
            Fact(key="material", value=self.material.name),
            Table(
                key="parameters", columns=PARAMETERS, rows=list(_parameters(self.fits)),
                is_shown=self.is_fit,
            ),
            *(TextLine(text=text) for text in _laws(self.fits)),
            TextLine(text=f"predictions: {self.how}"),
            Table(key="predictions", columns=PREDICTED, rows=self.predicted,
                  is_shown=not self.is_fit),
            Table(key="skills", columns=SKILLS, rows=self.skills),
            Findings(findings=self.findings),
        ])  # fmt: skip


def _skills(predictions: Sequence[CutPrediction]) -> Iterator[CutSkill]:
    for quantity in LawKind:
        skill = skill_of([each for each in predictions if each.quantity is quantity])
        if skill is not None:
            yield skill


def _parameters(fits: Sequence[FittedLaw]) -> Iterator[ParameterLine]:
    for fit in fits:
        prior, found = fit.posterior.prior, fit.posterior
        for at, name in enumerate(prior.names):
            yield ParameterLine(
                quantity=fit.law.quantity, name=name, mean=float(found.mean[at]),
                sd=float(found.covariance[at, at]) ** 0.5, prior_mean=float(prior.mean[at]),
                prior_sd=float(prior.sd[at]),
            )  # fmt: skip


def _laws(fits: Sequence[FittedLaw]) -> Iterator[str]:
    for fit in fits:
        text = f"{fit.law.quantity.value}: {len(fit.rows)} rows, one reading scatters by "
        text += f"{fit.posterior.sigma:.1%}"
        if fit.law.quantity is LawKind.FORCES:
            k_c11, exponent, _ = law_at_one(fit)
            text += f"; k_c1.1 {k_c11:.0f} N/mm², m_c {exponent:.3f}"
        yield text


def calibrated_cuts(
    request: CutChoice, table: Path, output: Path | None, *, is_forced: bool, tell: Tell
) -> CutsResult:
    """Fit a material to a table and, if an output is named, write its file.

    Raises
    ------
    StepNcError
        When a cell, a name or the output is invalid; when rows are too few; when a law predicts
        worse than a simpler rule and is not forced. Nothing is written then.
    """
    if output is not None:
        if output.suffix.lower() != ".toml":
            raise WriteError(
                "the name of a material file must end with .toml", path=str(output)
            )
        require_place(output, apart_from=table)
    known = known_material(request)
    read = read_cut_table(table)
    findings = list(read.findings)
    new = tuple(row for row in new_rows(read, known) if row.word("use") != "test")
    rows = (*known.rows, *new)
    fits, tested = [], []
    for quantity in quantities(request):
        served = rows_of(quantity, rows, criterion=request.wear_criterion_mm, findings=findings)
        if not served:
            continue
        if len(served) < FEWEST and quantity is LawKind.FORCES:
            raise CalibrationError(
                f"{len(served)} row of {quantity.value}; at least {FEWEST} are needed",
                path=str(table),
            )
        fit = fitted_law(quantity, known.start, served, edge=request.edge)
        fits.append(fit)
        findings += _doubts(fit)
        tested += left_out(quantity, known.start, served, edge=request.edge)
    if not fits:
        raise CalibrationError(_nothing(request), path=str(table))
    result = CutsResult(
        material=known.start, fits=tuple(fits), predicted=tuple(tested), is_fit=True,
        how="each condition from the others", findings=tuple(findings),
    )  # fmt: skip
    worse = [each for each in result.skills if each.is_worse]
    if worse and not is_forced and output is not None:
        raise StepNcError(
            "; ".join(map(_worse, worse)) + ": nothing is written; --anyway writes it"
        )
    warned = tuple(Finding(severity=Severity.WARNING, message=_worse(each)) for each in worse)
    if output is not None:
        write_atomically(output, _text(known, fits, rows, request).encode())
        read_material(output)
        tell(f"material file: {output}")
    return replace(result, findings=(*result.findings, *warned))


def _text(
    known: KnownMaterial,
    fits: Sequence[FittedLaw],
    rows: Sequence[CutRow],
    request: CutChoice,
) -> str:
    start: Kienzle = known.start.kienzle
    settings: dict[str, float | str] = {
        "edge_material": request.edge.value,
        "wear_criterion_mm": request.wear_criterion_mm,
        "prior_k_c11_n_mm2": start.k_c11,
        "prior_m_c": start.m_c,
    }
    taylor = next(
        (w.taylor for w in known.start.windows
         if w.cutting_material is request.edge and w.taylor is not None), None,
    )  # fmt: skip
    if taylor is not None:
        settings["prior_exponent"] = taylor.exponent
        settings["prior_constant_m_min"] = round(m_min_from_speed(taylor.constant), 9)
    return calibrated_text(known.text, fits, rows, settings=settings)


def validated_cuts(request: CutChoice, table: Path) -> CutsResult:
    """Predict the cuts of a table: rows to be fitted are marked, or kept by the material.

    Without either, each condition is predicted from the others.

    Raises
    ------
    StepNcError
        When a cell or a name is invalid, or the table holds nothing that is asked for.
    """
    known = known_material(request)
    read = read_cut_table(table)
    findings = list(read.findings)
    found, fits, hows = [], [], set()
    for quantity in quantities(request):
        served = rows_of(
            quantity, read.rows, criterion=request.wear_criterion_mm, findings=findings
        )
        kept = rows_of(quantity, known.rows, criterion=request.wear_criterion_mm, findings=[])
        if not served:
            continue
        fit_rows = (*kept, *(row for row in served if row.word("use") == "fit"))
        test = [row for row in served if row.word("use") != "fit"]
        if fit_rows and test:
            fit = fitted_law(quantity, known.start, fit_rows, edge=request.edge)
            fits.append(fit)
            found += predictions(fit, test)
            hows.add(f"{quantity.value} from {len(fit_rows)} fitted rows")
        elif all(row.word("use") == "test" for row in served):
            fit = fitted_law(quantity, known.start, (), edge=request.edge)
            found += predictions(fit, served)
            hows.add(f"{quantity.value} from the priors alone")
        else:
            found += left_out(quantity, known.start, served, edge=request.edge)
            hows.add(f"{quantity.value} of each condition from the others")
    if not found:
        raise CalibrationError(_nothing(request), path=str(table))
    return CutsResult(
        material=known.start, fits=tuple(fits), predicted=tuple(found), is_fit=False,
        how="; ".join(sorted(hows)), findings=tuple(findings),
    )  # fmt: skip


def _nothing(request: CutChoice) -> str:
    names = ", ".join(each.value for each in quantities(request))
    return (
        f"no row serves {names}: forces need feed_mm and cutting_force_n, roughness ra_um, "
        "feed_mm and nose_radius_mm, life cutting_speed_m_min and life_min or wear readings"
    )


def _worse(skill: CutSkill) -> str:
    return (
        f"{skill.quantity.value}: the law errs by {skill.error:.1%} on conditions that were "
        f"left out, {skill.baseline} by {skill.baseline_error:.1%}"
    )


def _doubts(fit: FittedLaw) -> Iterator[Finding]:
    """Yield rows of reduced weight, and what the rows do not tell."""
    weights = fit.posterior.weights
    off = [(row, w) for row, w in zip(fit.rows, weights, strict=True) if w < 0.5]
    for row, weight in off[:MOST_LISTED]:
        text = f"{fit.law.quantity.value}: lies off the others and counts {weight:.2f} times"
        yield Finding(severity=Severity.WARNING, message=text, line=row.line)
    if len(off) > MOST_LISTED:
        text = f"{len(off) - MOST_LISTED} more rows lie off the others"
        yield Finding(severity=Severity.WARNING, message=text)
    if fit.law.quantity is LawKind.FORCES and any(
        row.number("axial_depth_mm") is None
        and row.number("specific_cutting_force_n_mm2") is None
        for row in fit.rows
    ):
        text = (
            "forces: rows without axial_depth_mm tell the exponent and ratios of forces; "
            "the level of k_c stays near the catalogue's"
        )
        yield Finding(severity=Severity.WARNING, message=text)
    if len(fit.rows) < JUDGED:
        text = f"{fit.law.quantity.value}: {len(fit.rows)} rows are too few to judge the law"
        yield Finding(severity=Severity.NOTE, message=text)
