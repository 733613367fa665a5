"""Modes from a measured frequency response: peaks picked, then all of them fitted together.

``Φ(ω) = Σ (ω_n²/k)/(ω_n² − ω² + 2iζ·ω_n·ω) + r_0 + r_1/ω²``; the residues r stand for modes
above and below the measured range, and are left out of what is told. Units Hz, N/mm, mm/N.

References
----------
.. [1] D. J. Ewins, "Modal Testing: Theory, Practice and Application", 2nd ed., 2000, ch. 4:
   peak picking, half-power points and residuals.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares
from scipy.signal import find_peaks

from simulator.calibration.frequency_response import Complex, FrequencyResponse
from simulator.errors import CalibrationError
from simulator.motion.segments import Floats

LEAST_PEAK = 0.1
"""of the highest peak of the imaginary part; what is lower is no mode unless it is asked for"""

MOST_MODES = 8

DAMPING = (1e-4, 0.5)
"""range of ζ"""

USUAL_DAMPING = 0.03
"""where the width of a peak tells none"""


@dataclass(frozen=True, slots=True, kw_only=True)
class FittedMode:
    """One mode."""

    natural_frequency: float
    """Hz"""
    damping_ratio: float
    """ζ"""
    stiffness: float
    """N/mm"""


@dataclass(frozen=True, slots=True, kw_only=True)
class ModalFit:
    """Modes of one response, and what they do not explain."""

    modes: tuple[FittedMode, ...]
    """ascending in frequency"""
    residual: float
    """root mean square of what is left over that of the response, residues fitted with it"""
    unexplained: float
    """the same for the modes alone, as stability will use them"""


def fitted_modes(
    response: FrequencyResponse, *, count: int | None = None, path: str = ""
) -> ModalFit:
    """Modes of a response.

    Parameters
    ----------
    response : FrequencyResponse
    count : int, optional
        How many; by the peaks of the imaginary part when not given.
    path : str
        For messages.

    Raises
    ------
    CalibrationError
        There are no peaks, or not so many, or they point the wrong way.
    """
    picked = _picked(response, count, path=path)
    starts = [_start(response, row) for row in picked]
    modes, residues = _fit(response, starts)
    fitted = _model(response.frequency, modes, residues)
    alone = _model(response.frequency, modes, (0.0, 0.0))
    return ModalFit(
        modes=tuple(sorted(modes, key=lambda mode: mode.natural_frequency)),
        residual=_share(response, fitted),
        unexplained=_share(response, alone),
    )


def _picked(response: FrequencyResponse, count: int | None, *, path: str) -> list[int]:
    """Rows of the peaks of −Im, the highest first."""
    give = -response.receptance.imag
    if give.max() < -give.min():
        message = (
            "the imaginary part is positive at its greatest peak: "
            "is its sign that of e^(+iωt), and the response that of the tapped point?"
        )
        raise CalibrationError(message, path=path)
    # A mode is a few lines wide; what is narrower than the noise around it is none.
    found, _ = find_peaks(give, prominence=0.5 * LEAST_PEAK * float(give.max()))
    ranked = [int(row) for row in found[np.argsort(-give[found], kind="stable")]]
    if count is None:
        least = LEAST_PEAK * float(give.max())
        ranked = [row for row in ranked if give[row] >= least][:MOST_MODES]
    if not ranked:
        raise CalibrationError("no peak: the range holds no mode", path=path)
    if count is not None and len(ranked) < count:
        message = f"{len(ranked)} peaks, {count} modes are asked for"
        raise CalibrationError(message, path=path)
    return ranked[:count]


def _start(response: FrequencyResponse, row: int) -> FittedMode:
    """A mode by its peak: width at half of −Im is 2ζ·f, height 1/(2ζ·k)."""
    frequency, give = response.frequency, -response.receptance.imag
    half = 0.5 * give[row]
    low = row - int(np.argmax(give[row::-1] < half)) if (give[:row] < half).any() else row
    high = row + int(np.argmax(give[row:] < half)) if (give[row:] < half).any() else row
    width = float(frequency[high] - frequency[low])
    damping = 0.5 * width / float(frequency[row]) if width > 0.0 else USUAL_DAMPING
    damping = min(max(damping, 2.0 * DAMPING[0]), 0.5 * DAMPING[1])
    return FittedMode(
        natural_frequency=float(frequency[row]),
        damping_ratio=damping,
        stiffness=1.0 / (2.0 * damping * float(give[row])),
    )


def _fit(
    response: FrequencyResponse, starts: list[FittedMode]
) -> tuple[list[FittedMode], tuple[float, float]]:
    """Least squares of real and imaginary part, in logarithms of the modes' numbers."""
    frequency = response.frequency
    scale = float(np.abs(response.receptance).max())
    middle = float(np.median(frequency))
    first = np.log([
        [mode.natural_frequency, mode.damping_ratio, mode.stiffness] for mode in starts
    ])
    low, high = first.copy(), first.copy()
    for column, reach in ((0, np.log(1.2)), (2, np.log(100.0))):
        low[:, column] -= reach
        high[:, column] += reach
    low[:, 1], high[:, 1] = np.log(DAMPING[0]), np.log(DAMPING[1])

    def unpacked(values: Floats) -> tuple[list[FittedMode], tuple[float, float]]:
        rows = np.exp(values[:-2].reshape(-1, 3)).tolist()
        modes = [
            FittedMode(natural_frequency=f, damping_ratio=zeta, stiffness=k)
            for f, zeta, k in rows
        ]
        return modes, (values[-2] * scale, values[-1] * scale * middle**2)

    def misses(values: Floats) -> Floats:
        left = (_model(frequency, *unpacked(values)) - response.receptance) / scale
        return np.concatenate([left.real, left.imag])

    found = least_squares(
        misses,
        np.concatenate([first.ravel(), [0.0, 0.0]]),
        bounds=(
            np.concatenate([low.ravel(), [-np.inf, -np.inf]]),
            np.concatenate([high.ravel(), [np.inf, np.inf]]),
        ),
        x_scale="jac",
    )
    return unpacked(found.x)


def _model(
    frequency: Floats, modes: list[FittedMode], residues: tuple[float, float]
) -> Complex:
    """Receptance of the modes with their residues, mm/N."""
    total = np.asarray(residues[0] + residues[1] / frequency**2, dtype=np.complex128)
    for mode in modes:
        ratio = frequency / mode.natural_frequency
        total = total + 1.0 / mode.stiffness / (
            1.0 - ratio**2 + 2j * mode.damping_ratio * ratio
        )
    return total


def _share(response: FrequencyResponse, fitted: Complex) -> float:
    """Root mean square of a miss over that of the response."""
    left = np.abs(fitted - response.receptance)
    return float(np.sqrt(np.mean(left**2) / np.mean(np.abs(response.receptance) ** 2)))
