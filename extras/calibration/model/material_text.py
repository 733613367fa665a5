"""Text of a material's file with what a table of cuts taught it.

The file is edited as text, so that what was not learned stays as it is. The last table,
``[calibration]``, keeps the rows, from which a later call fits again with more of them, and
the priors from which the first call started.
"""

import hashlib
import re
from collections.abc import Mapping, Sequence
from math import exp
from pathlib import Path

import numpy as np

from extras.calibration.model.cut_fit import FittedLaw
from extras.calibration.model.cut_laws import (
    REFERENCE_CHIP,
    REFERENCE_DEPTH,
    REFERENCE_FEED,
    CutForceLaw,
    LawKind,
    LifeLaw,
)
from extras.calibration.model.cut_table import CutRow, kept_text
from simulator.files.material_file import CALIBRATION_VERSION
from simulator.motion.segments import Floats

Values = Mapping[str, float | str]


def calibrated_text(
    text: str, fits: Sequence[FittedLaw], rows: Sequence[CutRow], *, settings: Values
) -> str:
    """Text of a material's file with the fitted laws.

    Parameters
    ----------
    text : str
        The file as it was.
    fits : sequence of FittedLaw
        Laws that were fitted.
    rows : sequence of CutRow
        All rows of which they were.
    settings : mapping
        Further keys of ``[calibration]``: priors and the choice of the caller.
    """
    text = re.split(r"(?m)^\[calibration\]", text)[0].rstrip() + "\n"
    kept = kept_text(rows)
    tables = []
    for fit in fits:
        tables.append(_posterior(fit))
        if fit.law.quantity is LawKind.FORCES:
            text = _with_forces(text, fit)
        elif isinstance(fit.law, LifeLaw):
            text = _with_life(text, fit, fit.law)
    head = [
        "[calibration]",
        f"version = {CALIBRATION_VERSION}",
        f'digest = "{hashlib.sha256(kept.encode()).hexdigest()}"',
        *(_line(key, value) for key, value in settings.items()),
        f"rows = '''\n{kept}'''",
    ]
    return "\n".join([text, *head, "", *tables]).rstrip() + "\n"


def law_at_one(fit: FittedLaw) -> tuple[float, float, float]:
    """k_c1.1, m, and the spread of k_c of one reading with a tool as those of the rows.

    The mean over the fitted levels; the spread is at h = 0.2 mm.
    """
    mean, law = fit.posterior.mean, fit.law
    levels = len(law.levels) if isinstance(law, CutForceLaw) else 0
    slope = np.zeros((1, len(mean)))
    slope[0, 0] = 1.0
    if levels:
        slope[0, 4::2] = 1.0 / levels
    level = float(slope[0] @ mean)
    exponent = float(mean[1] + (mean[5::2].mean() if levels else 0.0))
    between = float(np.std(mean[4::2])) if levels else 0.0
    sd = float(fit.posterior.spread(slope, np.array([between]))[0])
    return exp(level) * REFERENCE_CHIP**exponent, exponent, exp(sd) - 1.0


def _with_forces(text: str, fit: FittedLaw) -> str:
    k_c11, exponent, spread = law_at_one(fit)
    # Without depth the level of the law is that of the catalogue, and only m is learned.
    source = f"{len(fit.rows)} measured cuts, law of ln k_c at h = 0.2 mm with priors"
    return _replaced(
        text, r"\[kienzle\]", {
            "k_c11_n_mm2": float(f"{k_c11:.5g}"), "m_c": float(f"{exponent:.4f}"),
            "source": source, "spread": float(f"{min(spread, 2.0):.3f}"),
            "spread_source": "posterior of the level, of one reading and between tools",
        },
    )  # fmt: skip


def _with_life(text: str, fit: FittedLaw, law: LifeLaw) -> str:
    """Taylor's constants at the mean feed and depth of the rows."""
    slope = law.curve(fit.rows)(fit.posterior.mean)[1].mean(axis=0)
    mean = fit.posterior.mean
    level = float(mean[0] + slope[2] * mean[2] + slope[3] * mean[3])
    constant = law.speed * exp(level / float(mean[1]))
    seen = {key: _mean([row.number(key) for row in fit.rows]) for key in MEANS}
    at = ", ".join(f"{key} {value:.3g}" for key, value in seen.items() if value)
    head = r'\[\[tool_life\]\]\ncutting_material = "' + law.edge_material + '"'
    return _replaced(
        text, head, {
            "exponent": float(f"{min(max(1.0 / float(mean[1]), 0.01), 0.99):.4f}"),
            "constant_m_min": float(f"{constant:.5g}"),
            "source": f"{len(fit.rows)} measured edges, at the mean {at}".rstrip(" ,at"),
            "feed_exponent": float(f"{max(float(mean[2]), 0.0):.4f}"),
            "depth_exponent": float(f"{max(float(mean[3]), 0.0):.4f}"),
            "feed_mm": float(f"{seen['feed_mm'] or REFERENCE_FEED:.4g}"),
            "depth_mm": float(f"{seen['axial_depth_mm'] or REFERENCE_DEPTH:.4g}"),
        },
    )  # fmt: skip


MEANS = ("feed_mm", "axial_depth_mm")


def _mean(values: Sequence[float | None]) -> float | None:
    known = [value for value in values if value]
    return float(np.exp(np.mean(np.log(known)))) if known else None


def _replaced(text: str, head: str, values: Values) -> str:
    """Set keys of the table that begins with a head."""
    found = re.search(rf"(?m)^{head}[^\n]*\n(?:(?!\[).*\n?)*", text)
    assert found is not None  # the file was read, so that the table is there
    table = found[0].rstrip() + "\n"
    for key, value in values.items():
        line = _line(key, value)
        new, count = re.subn(rf"(?m)^{key} = .*$", line.replace("\\", r"\\"), table)
        table = new if count else table + line + "\n"
    return text[: found.start()] + table + "\n" + text[found.end() :].lstrip("\n")


def _line(key: str, value: float | str) -> str:
    return f'{key} = "{value}"' if isinstance(value, str) else f"{key} = {value!r}"


def _posterior(fit: FittedLaw) -> str:
    found = fit.posterior
    names = ", ".join(f'"{name}"' for name in found.prior.names)
    scaled = found.covariance / np.outer(found.prior.sd, found.prior.sd)
    rows = ",\n".join(f"    {_numbers(row)}" for row in scaled)
    ranges = [
        f"{key} = [{min(seen)!r}, {max(seen)!r}]"
        for key in ("cutting_speed_m_min", "feed_mm", "axial_depth_mm")
        if (seen := [row.numbers[key] for row in fit.rows if key in row.numbers])
    ]
    return "\n".join([
        f"[calibration.{fit.law.quantity.value}]",
        f"names = [{names}]",
        f"mean = {_numbers(found.mean)}",
        f"prior_mean = {_numbers(found.prior.mean)}",
        f"prior_sd = {_numbers(found.prior.sd)}",
        f"covariance = [\n{rows},\n]  # over the prior's standard deviations",
        f"sigma = {found.sigma:.5g}",
        f"degrees = {found.degrees:.4g}",
        f"count = {len(fit.rows)}",
        "range = { " + ", ".join(ranges) + " }",
        "",
    ])


def _numbers(values: Floats) -> str:
    return "[" + ", ".join(f"{float(value):.8g}" for value in values) + "]"


def read_text(path: Path) -> str:
    """Text of a material's file, which was read and checked before."""
    return path.read_text(encoding="utf-8")
