"""Fit of Taylor's tool life constants to measured lives, for ``calibrate --life``.

Pairs of speed and life come from the command line or from a CSV file with the columns
``speed_m_min`` and ``life_min``. The result is a table for a material file.
"""

import csv
from dataclasses import dataclass
from math import isfinite
from pathlib import Path

from extras.calibration.model.tool_life import FittedTaylor, LifePair, fitted_taylor
from extras.calibration.verbs.calibrate.request import CalibrationFiles, CalibrationRequest
from service.files import open_lines, require_place, write_atomically
from service.progress import Tell
from service.rendering.view import Fact, ResultView, TextLine
from service.verbs.result import Result
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
class ToolLifeResult(Result):
    """Result of ``calibrate --life``."""

    cutting_material: CuttingMaterial
    fitted: FittedTaylor

    @property
    def usual_speed(self) -> float:
        """Cutting speed for a life of 15 min, in m/min."""
        life = USUAL_LIFE * SECONDS_PER_MINUTE
        return m_min_from_speed(speed_for_life(self.fitted.taylor, life))

    def view(self) -> ResultView:
        """Return the table of a material with comments on the quality of the fit."""
        found = self.fitted
        has = found.has_interval
        lines = (
            f"# {USUAL_LIFE:g} min of life at {self.usual_speed:.1f} m/min",
            f"# lives scatter by {found.scatter:.0%} about the law"
            if has
            else "# the law passes exactly through the two pairs; its error is unknown",
            *self.toml().splitlines(),
        )
        return ResultView([
            *(TextLine(text=line) for line in lines),
            Fact(key="cutting_material", value=self.cutting_material.value),
            Fact(key="exponent", value=found.taylor.exponent),
            Fact(key="exponent_low", value=found.low if has else None),
            Fact(
                key="exponent_high",
                value=found.high if has and isfinite(found.high) else None,
            ),
            Fact(key="constant_m_min", value=m_min_from_speed(found.taylor.constant)),
            Fact(key="scatter", value=found.scatter if has else None),
            Fact(key="slowest_m_min", value=m_min_from_speed(found.slowest)),
            Fact(key="fastest_m_min", value=m_min_from_speed(found.fastest)),
            Fact(key="pairs", value=found.pairs),
        ])

    def toml(self) -> str:
        """Return the ``[[tool_life]]`` table for a material file."""
        found = self.fitted
        slow, fast = m_min_from_speed(found.slowest), m_min_from_speed(found.fastest)
        source = (
            f"least squares in logarithms of {found.pairs} pairs, {slow:g} to {fast:g} m/min"
        )
        if found.has_interval:
            high = f"{found.high:.3f}" if isfinite(found.high) else "infinity"
            source += f"; exponent {found.low:.3f} to {high} (95 %)"
        return (
            "[[tool_life]]\n"
            f'cutting_material = "{self.cutting_material}"\n'
            f"exponent = {found.taylor.exponent:.4f}\n"
            f"constant_m_min = {m_min_from_speed(found.taylor.constant):.2f}\n"
            f'source = "{source}"\n'
        )


def tool_life_fit(
    request: CalibrationRequest, files: CalibrationFiles, tell: Tell
) -> ToolLifeResult:
    """Fit Taylor's constants and, if an output is named, write their table.

    Raises
    ------
    StepNcError
        When a pair is invalid, or no law can be fitted to the pairs.
    """
    output = files.output
    if output is not None:
        if output.suffix.lower() != ".toml":
            raise WriteError("the output name must end with .toml", path=str(output))
        if files.tool_life is not None:
            require_place(output, apart_from=files.tool_life)
    pairs = [_pair(text) for text in request.life]
    if files.tool_life is not None:
        pairs += _read(files.tool_life)
    result = ToolLifeResult(cutting_material=request.edge, fitted=fitted_taylor(pairs))
    if output is not None:
        write_atomically(output, result.toml().encode())
        tell(f"tool life: {output}")
    return result


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
