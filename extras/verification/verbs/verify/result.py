"""Result of ``verify``: deviations by surface, page, and file of places."""

from dataclasses import dataclass
from math import isfinite, isnan
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from extras.verification.facts import (
    RAW,
    UNSEEN,
    DeviationSpot,
    LogResolution,
    SurfaceDeviation,
    ToleranceBand,
    log_resolution,
    surface_deviations,
    tolerance_bands,
    write_surface,
)
from extras.verification.run import Verification
from service.errors import LIMIT_EXCEEDED, OK
from service.outputs.run_file import ColumnKind, RunColumn, RunFile, Words
from service.rendering.columns import Column, record
from service.rendering.text import RED
from service.rendering.view import Fact, Findings, ResultView, Table, TextLine
from service.storage.results import PLACES, SURFACE
from service.verbs.result import Result

if TYPE_CHECKING:
    import plotly.graph_objects as go

Row = SurfaceDeviation


def _time(spot: DeviationSpot) -> float | None:
    return None if isnan(spot.time) else spot.time


def _nominal(row: SurfaceDeviation) -> str | None:
    """Least and greatest deviation from the nominal feature."""
    if row.nominal is None:
        return None
    return " to ".join(f"{round(each, 4) + 0.0:+.4f}" for each in row.nominal)


def _at_least(row: SurfaceDeviation) -> float | None:
    """Least size of a deviation that is certain although it is below its uncertainty, mm."""
    worse = row.worse
    return worse.least if worse.is_beyond and worse.size <= worse.uncertainty else None


SURFACES: tuple[Column[Row], ...] = (
    Column(key="workingstep", heading="workingstep", is_key=True, kind=str,
           value=lambda row: row.workingstep),
    Column(key="feature", heading="feature", kind=str, value=lambda row: row.feature),
    Column(key="tool", heading="tool", value=lambda row: row.tool or None),
    Column(key="surface", heading="on", kind=str, value=lambda row: row.kind.value),
    Column(key="gouge_mm", heading="gouge mm", form=".4f", value=lambda row: row.gouge.size),
    Column(key="gouge_uncertainty_mm", heading="±", form=".4f",
           value=lambda row: row.gouge.uncertainty),
    Column(key="gouge_least_mm", value=lambda row: row.gouge.least),
    Column(key="gouge_at_mm", value=lambda row: row.gouge.position),
    Column(key="gouge_block", value=lambda row: row.gouge.block),
    Column(key="gouge_time_s", value=lambda row: _time(row.gouge)),
    Column(key="gouge_cut_by", value=lambda row: row.gouge.cut_by),
    Column(key="excess_mm", heading="excess mm", form=".4f", value=lambda row: row.excess.size),
    Column(key="excess_uncertainty_mm", heading="±", form=".4f",
           value=lambda row: row.excess.uncertainty),
    Column(key="excess_least_mm", value=lambda row: row.excess.least),
    Column(heading="at least mm", form=".4f", is_optional=True, value=_at_least),
    Column(key="excess_at_mm", value=lambda row: row.excess.position),
    Column(key="excess_block", value=lambda row: row.excess.block),
    Column(key="excess_time_s", value=lambda row: _time(row.excess)),
    Column(key="excess_cut_by", value=lambda row: row.excess.cut_by),
    Column(key="nominal_mm", value=lambda row: row.nominal),
    Column(heading="to nominal mm", is_optional=True, value=_nominal),
    Column(key="predicted_deflection_mm", heading="bent mm", form=".4f", is_optional=True,
           value=lambda row: row.bent),
    Column(key="area_mm2", value=lambda row: row.area),
    Column(key="beyond", heading="beyond ±", form=".1%", value=lambda row: row.beyond),
    Column(heading="worse at mm", value=lambda row: _place(row.worse)),
    Column(heading="block", value=lambda row: row.worse.block or None),
    Column(heading="time s", form=".2f", value=lambda row: _time(row.worse)),
    Column(heading="cut by", value=lambda row: row.worse.cut_by),
)  # fmt: skip

BAND_COLUMNS: tuple[Column[ToleranceBand], ...] = (
    Column(key="width_mm", heading="within ± mm", form="g", value=lambda row: row.width),
    Column(key="share", heading="share", form=".2%", value=lambda row: row.share),
)

RESOLUTION: tuple[Column[LogResolution], ...] = (
    Column(key="step_mm", value=lambda row: row.step),
    Column(key="straight_mm", value=lambda row: row.straight),
    Column(key="arc_mm", value=lambda row: row.arc),
    Column(key="arc_radius_mm", value=lambda row: row.radius),
    Column(key="square_corner_mm", value=lambda row: row.corner),
)


BENT = (
    "bent: predicted deflection of the tool away from the wall, which the log does not see; "
    "material of up to this thickness is left on top of the excess"
)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class VerificationResult(Result):
    """Result of ``verify``."""

    verification: Verification

    @property
    def exit_code(self) -> int:
        """5 if a deviation exceeds its uncertainty and the tolerance."""
        return LIMIT_EXCEEDED if self.verification.has_errors else OK

    @property
    def verdict(self) -> str:
        """Sum of the deviations beyond uncertainty and tolerance."""
        return _verdict(self.verification, self.rows())

    def rows(self) -> list[SurfaceDeviation]:
        """Deviations by surface."""
        return list(surface_deviations(self.verification))

    def view(self) -> ResultView:
        """Return deviations, volumes, tolerance bands and what the log can resolve."""
        found, rows = self.verification, self.rows()
        volumes, facts, bands = found.volumes, found.facts, tolerance_bands(found)
        shares = ", ".join(f"±{band.width:g} mm {band.share:.2%}" for band in bands)
        verdict = _verdict(found, rows)
        head = f"{found.log}: positions against {found.program} on {found.machine.name}"
        removed = (
            f"removed {volumes.logged:.1f} mm³, programmed {volumes.programmed:.1f} mm³; "
            f"gouges {volumes.gouge:.3g} mm³, excess {volumes.excess:.3g} mm³"
        )
        return ResultView([
            TextLine(text=head),
            Fact(key="program", value=found.program),
            Fact(key="machine", value=found.machine.name),
            Fact(key="log", value=found.log),
            Fact(key="zero_mm", value=found.zero),
            Fact(key="tolerance_mm", value=found.tolerance),
            Fact(key="has_errors", value=found.has_errors),
            Fact(key="verdict", value=verdict),
            Table(
                key="surfaces", columns=SURFACES, rows=rows,
                colour=lambda row: RED if _is_wrong(row, found.tolerance) else "",
            ),
            TextLine(text=removed),
            Fact(
                key="volumes",
                value={
                    "programmed_mm3": volumes.programmed,
                    "logged_mm3": volumes.logged,
                    "gouge_mm3": volumes.gouge,
                    "excess_mm3": volumes.excess,
                },
            ),
            TextLine(text=f"share of the surface within {shares}"),
            Table(key="bands", columns=BAND_COLUMNS, rows=bands, is_shown=False),
            TextLine(text=f"verdict: {verdict}"),
            *([TextLine(text=BENT)] if found.bent else []),
            Fact(
                key="samples",
                value={
                    "count": facts.samples,
                    "interval_s": facts.interval,
                    "rounding_mm": facts.rounding,
                    "gaps": facts.gaps,
                    "longest_gap_s": facts.longest_gap,
                },
            ),
            TextLine(text=f"this log: {self.resolution}"),
            Fact(key="resolution", value=record(RESOLUTION, log_resolution(found))),
            Fact(key="cell_mm", value=found.cell),
            TextLine(text="position feedback does not see:"),
            *(TextLine(text=f"  {text}") for text in UNSEEN),
            Fact(key="not_seen", value=UNSEEN),
            Findings(findings=found.findings),
        ])  # fmt: skip

    @property
    def resolution(self) -> str:
        """Resolution of the log, in words."""
        facts, can = self.verification.facts, log_resolution(self.verification)
        rounding = f"rounded to {facts.rounding:g} mm" if facts.rounding else "not rounded"
        rate = f"{1.0 / facts.interval:.3g} Hz" if facts.interval > 0.0 else "unknown rate"
        has_arcs = isfinite(can.radius)
        arcs = f", {can.arc:.4f} mm on arcs of R {can.radius:.3g} mm" if has_arcs else ""
        return (
            f"{facts.samples} positions at {rate}, {rounding}, {can.step:.3g} mm apart in the "
            f"cut: it resolves {can.straight:.4f} mm on straights{arcs}, {can.corner:.4f} mm "
            f"at square corners; places are known to a cell of {self.verification.cell:.3g} mm"
        )

    def figures(self) -> "tuple[go.Figure, go.Figure]":
        """Return the plan of the deviations, and the part in space."""
        from extras.verification.figures import (  # noqa: PLC0415 (plotly)
            plan_figure,
            space_figure,
        )

        return plan_figure(self.verification), space_figure(self.verification)

    def page(self) -> str:
        """Return a self-contained page with both figures."""
        from service.rendering.pages import plot, rendered  # noqa: PLC0415 (Jinja)

        plan, space = self.figures()
        return rendered(
            "verification.html.jinja",
            found=self.verification,
            verdict=self.verdict,
            plan=plot(plan, "plan"),
            space=plot(space, "space"),
            surfaces=SURFACES,
            rows=self.rows(),
            band_columns=BAND_COLUMNS,
            bands=tolerance_bands(self.verification),
            resolution=self.resolution,
            unseen=UNSEEN,
        )

    def kept(self, folder: Path) -> dict[str, Any]:
        """Write places as CSV and Parquet, and the surface for maps."""
        for suffix in (".csv", ".parquet"):
            self.write_places(folder / f"{PLACES}{suffix}")
        write_surface(folder / SURFACE, self.verification)
        return self.record()

    def write_places(self, path: Path) -> int:
        """Write places as Parquet or CSV: all on walls, others beyond their uncertainty.

        Raises
        ------
        WriteError
            When the suffix is another, or the file cannot be written.
        """
        found = self.verification
        places = found.places[found.places.is_wall | found.places.is_beyond]
        names = [*(step.workingstep for step in found.steps), RAW]
        numbers = {
            **{f"{axis}_mm": places.position[:, row] for row, axis in enumerate("xyz")},
            "deviation_mm": places.deviation,
            "uncertainty_mm": places.uncertainty,
            "least_mm": places.least,
            "time_s": places.time,
            "block": places.block,
        }
        columns = [
            RunColumn(name=name, kind=ColumnKind(values.dtype.name))
            for name, values in numbers.items()
        ]
        file = RunFile(path, [*columns, RunColumn(name="workingstep", kind=ColumnKind.WORDS)])
        with file.closing(is_whole=True):
            file.write([
                *numbers.values(),
                Words(codes=np.asarray(places.workingstep % len(names), np.int32), names=names),
            ])
        return file.rows


def _verdict(verification: Verification, rows: list[SurfaceDeviation]) -> str:
    """Sum up the deviations beyond uncertainty and tolerance."""
    wrong = [row for row in rows if _is_wrong(row, verification.tolerance)]
    if wrong:
        names = ", ".join(dict.fromkeys(row.workingstep for row in wrong))
        least = f"{verification.tolerance:g} mm"
        return f"deviations of {least} or more beyond the uncertainty: {names}"
    beyond = [row for row in rows if row.worse.is_beyond]
    if beyond:
        worst = max(row.worse.size for row in beyond)
        return f"within {verification.tolerance:g} mm; greatest deviation seen {worst:.4f} mm"
    return "nothing beyond the uncertainty of the log"


def _place(spot: DeviationSpot) -> str:
    return ", ".join(f"{each:.2f}" for each in spot.position)


def _is_wrong(row: SurfaceDeviation, tolerance: float) -> bool:
    pair = (row.gouge, row.excess)
    return any(spot.is_beyond and spot.size >= tolerance - 1e-9 for spot in pair)
