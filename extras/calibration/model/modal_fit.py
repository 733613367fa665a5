"""Modes fitted to a measured frequency response: peaks picked, then fitted together.

``Φ(ω) = Σ (ω_n²/k)/(ω_n² − ω² + 2iζ·ω_n·ω) + r_0 + r_1/ω²``; the residues r represent modes
above and below the measured range, and are not reported. Units Hz, N/mm, mm/N.

The frequency response comes from a tap test at the tool point or the workpiece. The file is CSV
with a column ``frequency_hz`` and the real and imaginary part, with the unit in their headings:
receptance in m/N, mm/N or µm/N, or accelerance in m/s²/N. Case and punctuation in headings are
ignored: ``Real (µm/N)`` is read as ``real_um_n``.

References
----------
.. [1] D. J. Ewins, "Modal Testing: Theory, Practice and Application", 2nd ed., 2000, ch. 4:
   peak picking, half-power points and residuals.
"""

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.signal import find_peaks

from extras.calibration.model.measured_run import read_columns
from simulator.errors import CalibrationError
from simulator.motion.segments import Floats, Ints
from stepnc_model.units import MM_PER_M

Complex = NDArray[np.complex128]

FREQUENCY = "frequency_hz"
MM_PER_N = {"m_n": 1e3, "mm_n": 1.0, "um_n": 1e-3}
"""Receptance in mm/N per unit."""
ACCELERANCE = "m_s2_n"
UNITS = (*MM_PER_N, ACCELERANCE)
HIGHEST = 100_000.0
"""Highest plausible frequency, Hz; no tap excites more."""
LOWEST = 1e-3
"""Lowest frequency above 0 that is read, Hz; a line below it tells nothing of a mode."""
MOST_RECEPTANCE = 1e6
"""Greatest plausible receptance, mm/N."""
LEAST_RECEPTANCE = 1e-12
"""Least plausible receptance at the highest peak, mm/N; no machine is that stiff."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FrequencyResponse:
    """Receptance at N frequencies, in the direction of the tap."""

    name: str
    frequency: Floats
    """Frequency, (N,), Hz, ascending, positive."""
    receptance: Complex
    """Complex receptance, (N,), mm/N."""


def read_response(path: Path) -> FrequencyResponse:
    """Read and check a frequency response from a CSV file.

    Rows below 0.001 Hz are skipped: they contain no information on modes.

    Raises
    ------
    CalibrationError
        If a column is missing or has non-numeric cells, the frequency does not ascend, or
        all values are zero.
    """
    parts = [f"{part}_{unit}" for part in ("real", "imag") for unit in UNITS]
    columns, lines = read_columns(path, wanted=(FREQUENCY, *parts), spelt=spelt)
    if FREQUENCY not in columns:
        raise CalibrationError(
            "column is missing; it must hold the frequency in Hz",
            path=str(path),
            column=FREQUENCY,
        )
    unit = _unit(columns, path)
    frequency = columns[FREQUENCY]
    _check_frequency(frequency, lines=lines, path=path)
    rows = frequency >= LOWEST
    frequency = frequency[rows]
    measured = columns[f"real_{unit}"][rows] + 1j * columns[f"imag_{unit}"][rows]
    if not len(frequency):
        message = f"no frequency of at least {LOWEST:g} Hz"
        raise CalibrationError(message, path=str(path), column=FREQUENCY)
    if not measured.any():
        raise CalibrationError("all values are zero", path=str(path), column=f"real_{unit}")
    factor = MM_PER_N.get(unit, 1.0) * np.ones(len(frequency))
    if unit == ACCELERANCE:
        factor = -MM_PER_M / (2.0 * np.pi * frequency) ** 2
    with np.errstate(over="ignore", invalid="ignore"):
        receptance: Complex = (factor * measured).astype(np.complex128)
        size = np.abs(receptance)
    _check_receptance(size, lines=lines[rows], path=path, column=f"real_{unit}")
    return FrequencyResponse(name=path.stem, frequency=frequency, receptance=receptance)


def spelt(heading: str) -> str:
    """Normalise a heading for comparison.

    Examples
    --------
    >>> spelt(" Real [µm/N]"), spelt("Imaginary part (m/s²/N)"), spelt("Freq (Hz)")
    ('real_um_n', 'imag_m_s2_n', 'frequency_hz')
    """
    plain = heading.lower().replace("µ", "u").replace("μ", "u").replace("²", "2")
    words = re.sub(r"[^a-z0-9]+", "_", plain).strip("_").split("_")
    whole = {"freq": "frequency", "imaginary": "imag", "re": "real", "im": "imag"}
    return "_".join(whole.get(word, word) for word in words if word != "part")


def _unit(columns: dict[str, Floats], path: Path) -> str:
    """Unit in which real and imaginary part are given."""
    given = [unit for unit in UNITS if f"real_{unit}" in columns]
    if not given:
        known = ", ".join(f"real_{unit}" for unit in UNITS)
        raise CalibrationError(
            f"no column with the real part; one of {known} is needed", path=str(path)
        )
    (unit, *others) = given
    if others:
        message = f"given together with {f'real_{others[0]}'}; use one unit only"
        raise CalibrationError(message, path=str(path), column=f"real_{unit}")
    if f"imag_{unit}" not in columns:
        raise CalibrationError("column is missing", path=str(path), column=f"imag_{unit}")
    return unit


def _check_frequency(frequency: Floats, *, lines: Ints, path: Path) -> None:
    """Check that frequencies ascend within the range that a tap excites."""
    steps = np.diff(frequency)
    if (steps <= 0.0).any():
        row = int(np.argmax(steps <= 0.0)) + 1
        message = (
            f"{frequency[row]:g} Hz after {frequency[row - 1]:g} Hz; frequencies must ascend"
        )
        line = int(lines[row])
        raise CalibrationError(message, path=str(path), line=line, column=FREQUENCY)
    if frequency[0] < 0.0 or frequency[-1] > HIGHEST:
        row = 0 if frequency[0] < 0.0 else int(np.argmax(frequency > HIGHEST))
        message = f"{frequency[row]:g} Hz, expected 0 to {HIGHEST:g} Hz"
        line = int(lines[row])
        raise CalibrationError(message, path=str(path), line=line, column=FREQUENCY)


def _check_receptance(size: Floats, *, lines: Ints, path: Path, column: str) -> None:
    """Check that receptances are those of a machine, so that their squares are numbers."""
    row = int(np.argmax(size))
    # A value that overflowed is not a number, and the greatest to argmax.
    if not LEAST_RECEPTANCE <= size[row] <= MOST_RECEPTANCE:
        message = (
            f"a greatest receptance of {size[row]:.3g} mm/N: expected {LEAST_RECEPTANCE:g} to "
            f"{MOST_RECEPTANCE:g} mm/N; check the unit"
        )
        raise CalibrationError(message, path=str(path), line=int(lines[row]), column=column)


LEAST_PEAK = 0.1
"""Least height of a peak of the imaginary part over the highest one; lower peaks are modes
only if requested."""

MOST_MODES = 8

DAMPING = (1e-4, 0.5)
"""Permitted range of the damping ratio ζ."""

USUAL_DAMPING = 0.03
"""Damping ratio assumed if it cannot be found from the width of a peak."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FittedMode:
    """Mode of vibration fitted to a frequency response."""

    natural_frequency: float
    """Natural frequency, Hz."""
    damping_ratio: float
    """Damping ratio ζ."""
    stiffness: float
    """Modal stiffness, N/mm."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ModalFit:
    """Modes fitted to one frequency response, and the remaining error."""

    modes: tuple[FittedMode, ...]
    """Fitted modes, ascending in frequency."""
    residual: float
    """Root mean square error over that of the response, including the residues."""
    unexplained: float
    """Root mean square error over that of the response for the modes alone, as in stability."""


def fitted_modes(
    response: FrequencyResponse, *, count: int | None = None, path: str = ""
) -> ModalFit:
    """Fit modes to a frequency response.

    Parameters
    ----------
    response : FrequencyResponse
    count : int, optional
        Number of modes; by default from the peaks of the imaginary part.
    path : str
        File name for messages.

    Raises
    ------
    CalibrationError
        If there are no peaks, fewer than requested, or they have the wrong sign.
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
            "the imaginary part is positive at its highest peak: check that it follows "
            "the sign convention e^(+iωt) and was measured at the tapped point"
        )
        raise CalibrationError(message, path=path)
    # A mode is a few lines wide; a peak narrower than the noise around it is not a mode.
    found, _ = find_peaks(give, prominence=0.5 * LEAST_PEAK * float(give.max()))
    ranked = [int(row) for row in found[np.argsort(-give[found], kind="stable")]]
    if count is None:
        least = LEAST_PEAK * float(give.max())
        ranked = [row for row in ranked if give[row] >= least][:MOST_MODES]
    if not ranked:
        raise CalibrationError("no peak found: the range contains no mode", path=path)
    if count is not None and len(ranked) < count:
        message = f"{len(ranked)} peaks found, but {count} modes were requested"
        raise CalibrationError(message, path=path)
    return ranked[:count]


def _start(response: FrequencyResponse, row: int) -> FittedMode:
    """Initial mode from a peak: width at half of −Im is 2ζ·f, height 1/(2ζ·k)."""
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
    """Fit real and imaginary part by least squares over the logarithms of the parameters."""
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
    """Receptance of modes and residues, mm/N."""
    total = np.asarray(residues[0] + residues[1] / frequency**2, dtype=np.complex128)
    for mode in modes:
        ratio = frequency / mode.natural_frequency
        total = total + 1.0 / mode.stiffness / (
            1.0 - ratio**2 + 2j * mode.damping_ratio * ratio
        )
    return total


def _share(response: FrequencyResponse, fitted: Complex) -> float:
    """Root mean square error of a fit over that of the response."""
    left = np.abs(fitted - response.receptance)
    return float(np.sqrt(np.mean(left**2) / np.mean(np.abs(response.receptance) ** 2)))
