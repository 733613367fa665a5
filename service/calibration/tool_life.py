"""Fit of Taylor's tool life constants to measured lives, for ``calibrate --life``.

Pairs of speed and life come from the command line or from a CSV file with the columns
``speed_m_min`` and ``life_min``. The result is a table for a material file.
"""

import csv
from dataclasses import dataclass
from math import isfinite
from pathlib import Path

from service.files import open_lines, require_place, write_atomically
from service.rendering.records import dump
from simulator.calibration.tool_life import FittedTaylor, LifePair, fitted_taylor
from simulator.physics.tool_life import speed_for_life
from simulator.spec import CuttingMaterial
from stepnc_model.errors import StepNcError, WriteError
from stepnc_model.units import (
    SECONDS_PER_MINUTE,
    m_min_from_speed,
    speed_from_m_min,
)

SPEED, LIFE = "speed_m_min", "life_min"
COLUMNS = (SPEED, LIFE)

USUAL_LIFE = 15.0
"""Tool life for which catalogues state cutting speeds, in min."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolLifeRequest:
    """Request of ``calibrate --life``."""

    pairs: tuple[str, ...] = ()
    """Pairs such as ``120:25``, cutting speed in m/min and life in min."""
    file: Path | None = None
    """CSV file with further pairs."""
    cutting_material: str = CuttingMaterial.CARBIDE
    output: Path | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolLifeResult:
    """Result of ``calibrate --life``."""

    cutting_material: CuttingMaterial
    fitted: FittedTaylor

    @property
    def usual_speed(self) -> float:
        """Cutting speed for a life of 15 min, in m/min."""
        life = USUAL_LIFE * SECONDS_PER_MINUTE
        return m_min_from_speed(speed_for_life(self.fitted.taylor, life))


def calibrate_tool_life(request: ToolLifeRequest) -> ToolLifeResult:
    """Fit Taylor's constants and, if an output is named, write their table.

    Raises
    ------
    StepNcError
        When a pair is invalid, or no law can be fitted to the pairs.
    """
    try:
        material = CuttingMaterial(request.cutting_material)
    except ValueError:
        known = ", ".join(CuttingMaterial)
        text = f"unknown cutting material '{request.cutting_material}'; known: {known}"
        raise StepNcError(text) from None
    if request.output is not None:
        if request.output.suffix.lower() != ".toml":
            raise WriteError("the output name must end with .toml", path=str(request.output))
        if request.file is not None:
            require_place(request.output, apart_from=request.file)
    pairs = [_pair(text) for text in request.pairs]
    if request.file is not None:
        pairs += _read(request.file)
    result = ToolLifeResult(cutting_material=material, fitted=fitted_taylor(pairs))
    if request.output is not None:
        write_atomically(request.output, tool_life_toml(result).encode())
    return result


def tool_life_toml(result: ToolLifeResult) -> str:
    """Return the ``[[tool_life]]`` table for a material file."""
    found = result.fitted
    slow, fast = m_min_from_speed(found.slowest), m_min_from_speed(found.fastest)
    source = f"least squares in logarithms of {found.pairs} pairs, {slow:g} to {fast:g} m/min"
    if found.has_interval:
        high = f"{found.high:.3f}" if isfinite(found.high) else "infinity"
        source += f"; exponent {found.low:.3f} to {high} (95 %)"
    return (
        "[[tool_life]]\n"
        f'cutting_material = "{result.cutting_material}"\n'
        f"exponent = {found.taylor.exponent:.4f}\n"
        f"constant_m_min = {m_min_from_speed(found.taylor.constant):.2f}\n"
        f'source = "{source}"\n'
    )


def tool_life_text(result: ToolLifeResult) -> str:
    """Return the table with comments on the quality of the fit."""
    found = result.fitted
    lines = [f"# {USUAL_LIFE:g} min of life at {result.usual_speed:.1f} m/min"]
    if found.has_interval:
        lines.append(f"# lives scatter by {found.scatter:.0%} about the law")
    else:
        lines.append("# the law passes exactly through the two pairs; its error is unknown")
    return "\n".join((*lines, tool_life_toml(result)))


def tool_life_json(result: ToolLifeResult) -> str:
    """Return constants, interval and range as JSON; keys carry their units and never change."""
    found = result.fitted
    has = found.has_interval
    return dump({
        "cutting_material": result.cutting_material.value,
        "exponent": found.taylor.exponent,
        "exponent_low": found.low if has else None,
        "exponent_high": found.high if has and isfinite(found.high) else None,
        "constant_m_min": m_min_from_speed(found.taylor.constant),
        "scatter": found.scatter if has else None,
        "slowest_m_min": m_min_from_speed(found.slowest),
        "fastest_m_min": m_min_from_speed(found.fastest),
        "pairs": found.pairs,
    })


def _pair(text: str) -> LifePair:
    """Parse a pair such as ``120:25`` as m/min and min."""
    words = text.split(":")
    if len(words) != 2:
        raise StepNcError(f"--life {text}: is not a pair; write 120:25 for 25 min at 120 m/min")
    return _life(*words, place=f"--life {text}")


def _read(path: Path) -> list[LifePair]:
    """Read the pairs of a CSV file; other columns are ignored."""
    rows = csv.DictReader(open_lines(path))
    missing = [name for name in COLUMNS if name not in (rows.fieldnames or ())]
    if missing:
        raise StepNcError(f"{path}: missing column {' and '.join(missing)}")
    return [
        _life(row[SPEED] or "", row[LIFE] or "", place=f"{path}, line {rows.line_num}")
        for row in rows
    ]


def _life(speed: str, life: str, *, place: str) -> LifePair:
    """Convert the texts of a speed and a life to a pair."""
    try:
        return LifePair(
            cutting_speed=speed_from_m_min(float(speed)),
            life=float(life) * SECONDS_PER_MINUTE,
        )
    except ValueError:
        raise StepNcError(f"{place}: '{speed}' and '{life}' must be two numbers") from None
