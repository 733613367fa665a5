"""Result of a verification as text, JSON, HTML page, and file of places."""

from math import isfinite, isnan
from pathlib import Path

import numpy as np

from service.rendering.columns import Column
from service.rendering.records import dump, finding_record, records
from service.rendering.text import RED, print_findings, print_line, screen_width, table
from service.run_file import ColumnKind, RunColumn, RunFile, Words
from service.verification.facts import (
    RAW,
    UNSEEN,
    DeviationSpot,
    LogResolution,
    SurfaceDeviation,
    ToleranceBand,
    log_resolution,
    surface_deviations,
    tolerance_bands,
)
from service.verification.run import Verification

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


def print_verification(found: Verification) -> None:
    """Print deviations, volumes, tolerance bands and what the log can resolve."""
    print_line(f"{found.log}: positions against {found.program} on {found.machine.name}")
    rows = list(surface_deviations(found))
    for line in table(
        SURFACES, rows, width=screen_width(), colour=lambda row: _colour(row, found.tolerance)
    ):
        print_line(line)
    volumes = found.volumes
    print_line(
        f"removed {volumes.logged:.1f} mm³, programmed {volumes.programmed:.1f} mm³; "
        f"gouges {volumes.gouge:.3g} mm³, excess {volumes.excess:.3g} mm³"
    )
    bands = ", ".join(f"±{band.width:g} mm {band.share:.2%}" for band in tolerance_bands(found))
    print_line(f"share of the surface within {bands}")
    print_line(f"verdict: {verdict(found, rows)}")
    if found.bent:
        print_line(BENT)
    print_line(f"this log: {resolution_text(found)}")
    print_line("position feedback does not see:")
    for text in UNSEEN:
        print_line(f"  {text}")
    print_findings(found.findings)


def verification_json(found: Verification) -> str:
    """Return the verification as JSON."""
    rows = list(surface_deviations(found))
    volumes, facts = found.volumes, found.facts
    return dump({
        "program": found.program,
        "machine": found.machine.name,
        "log": found.log,
        "zero_mm": found.zero,
        "tolerance_mm": found.tolerance,
        "has_errors": found.has_errors,
        "verdict": verdict(found, rows),
        "surfaces": records(SURFACES, rows),
        "volumes": {
            "programmed_mm3": volumes.programmed,
            "logged_mm3": volumes.logged,
            "gouge_mm3": volumes.gouge,
            "excess_mm3": volumes.excess,
        },
        "bands": records(BAND_COLUMNS, tolerance_bands(found)),
        "samples": {
            "count": facts.samples,
            "interval_s": facts.interval,
            "rounding_mm": facts.rounding,
            "gaps": facts.gaps,
            "longest_gap_s": facts.longest_gap,
        },
        "resolution": records(RESOLUTION, [log_resolution(found)])[0],
        "cell_mm": found.cell,
        "not_seen": UNSEEN,
        "findings": [finding_record(finding) for finding in found.findings],
    })


def verification_page(found: Verification) -> str:
    """Return the HTML report of a verification."""
    from service.rendering.pages import plot, rendered  # noqa: PLC0415 (Jinja)
    from service.verification.figures import (  # noqa: PLC0415 (plotly)
        plan_figure,
        space_figure,
    )

    rows = list(surface_deviations(found))
    return rendered(
        "verification.html.jinja",
        found=found,
        verdict=verdict(found, rows),
        plan=plot(plan_figure(found), "plan"),
        space=plot(space_figure(found), "space"),
        surfaces=SURFACES,
        rows=rows,
        band_columns=BAND_COLUMNS,
        bands=tolerance_bands(found),
        resolution=resolution_text(found),
        unseen=UNSEEN,
    )


def write_places(path: Path, found: Verification) -> int:
    """Write places as Parquet or CSV: all on walls, others beyond their uncertainty.

    Raises
    ------
    WriteError
        When the suffix is another, or the file cannot be written.
    """
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


def verdict(found: Verification, rows: list[SurfaceDeviation]) -> str:
    """Sum up the deviations beyond uncertainty and tolerance."""
    wrong = [row for row in rows if _is_wrong(row, found.tolerance)]
    if wrong:
        names = ", ".join(dict.fromkeys(row.workingstep for row in wrong))
        return f"deviations of {found.tolerance:g} mm or more beyond the uncertainty: {names}"
    beyond = [row for row in rows if row.worse.is_beyond]
    if beyond:
        worst = max(row.worse.size for row in beyond)
        return f"within {found.tolerance:g} mm; greatest deviation seen {worst:.4f} mm"
    return "nothing beyond the uncertainty of the log"


def resolution_text(found: Verification) -> str:
    """Say what the log can resolve."""
    facts, can = found.facts, log_resolution(found)
    rounding = f"rounded to {facts.rounding:g} mm" if facts.rounding else "not rounded"
    rate = f"{1.0 / facts.interval:.3g} Hz" if facts.interval > 0.0 else "unknown rate"
    arcs = (
        f", {can.arc:.4f} mm on arcs of R {can.radius:.3g} mm" if isfinite(can.radius) else ""
    )
    return (
        f"{facts.samples} positions at {rate}, {rounding}, {can.step:.3g} mm apart in the cut: "
        f"it resolves {can.straight:.4f} mm on straights{arcs}, {can.corner:.4f} mm at square "
        f"corners; places are known to a cell of {found.cell:.3g} mm"
    )


def _place(spot: DeviationSpot) -> str:
    return ", ".join(f"{each:.2f}" for each in spot.position)


def _is_wrong(row: SurfaceDeviation, tolerance: float) -> bool:
    pair = (row.gouge, row.excess)
    return any(spot.is_beyond and spot.size >= tolerance - 1e-9 for spot in pair)


def _colour(row: SurfaceDeviation, tolerance: float) -> str:
    return RED if _is_wrong(row, tolerance) else ""
