"""A measured frequency response: what a tap test shows at the tool point or the workpiece.

The file is CSV with a column ``frequency_hz`` and the real and the imaginary part, the unit in
their headings: receptance in m/N, mm/N or µm/N, or accelerance in m/s²/N. Headings are read
without regard to case and signs between their words: ``Real (µm/N)`` is ``real_um_n``.
"""

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from simulator.calibration.measured_run import read_columns
from simulator.errors import CalibrationError
from simulator.motion.segments import Floats, Ints

Complex = NDArray[np.complex128]

FREQUENCY = "frequency_hz"
MM_PER_N = {"m_n": 1e3, "mm_n": 1.0, "um_n": 1e-3}
"""mm/N per unit of a receptance"""
ACCELERANCE = "m_s2_n"
UNITS = (*MM_PER_N, ACCELERANCE)
MM_PER_M = 1e3
HIGHEST = 100_000.0
"""Hz; no tap excites more"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FrequencyResponse:
    """Receptance at N frequencies, in the direction of the tap."""

    name: str
    frequency: Floats
    """(N,) Hz, ascending, positive"""
    receptance: Complex
    """(N,) mm/N"""


def read_response(path: Path) -> FrequencyResponse:
    """Frequency response of a CSV file, checked.

    A first line at 0 Hz is left out: it tells nothing of a mode.

    Raises
    ------
    CalibrationError
        A column is missing or holds no numbers, the frequency does not ascend, or all is zero.
    """
    parts = [f"{part}_{unit}" for part in ("real", "imag") for unit in UNITS]
    columns, lines = read_columns(path, wanted=(FREQUENCY, *parts), spelt=spelt)
    if FREQUENCY not in columns:
        raise CalibrationError("missing; frequency in Hz", path=str(path), column=FREQUENCY)
    unit = _unit(columns, path)
    frequency = columns[FREQUENCY]
    _check_frequency(frequency, lines=lines, path=path)
    rows = frequency > 0.0
    frequency = frequency[rows]
    measured = columns[f"real_{unit}"][rows] + 1j * columns[f"imag_{unit}"][rows]
    if not np.abs(measured).any():
        raise CalibrationError("zero throughout", path=str(path), column=f"real_{unit}")
    factor = MM_PER_N.get(unit, 1.0) * np.ones(len(frequency))
    if unit == ACCELERANCE:
        factor = -MM_PER_M / (2.0 * np.pi * frequency) ** 2
    receptance: Complex = (factor * measured).astype(np.complex128)
    return FrequencyResponse(name=path.stem, frequency=frequency, receptance=receptance)


def spelt(heading: str) -> str:
    """A heading as it is compared.

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
    """Unit in which both parts are given."""
    given = [unit for unit in UNITS if f"real_{unit}" in columns]
    if not given:
        known = ", ".join(f"real_{unit}" for unit in UNITS)
        raise CalibrationError(f"no real part; one of {known} is needed", path=str(path))
    (unit, *others) = given
    if others:
        message = f"beside {f'real_{others[0]}'}; one unit is enough"
        raise CalibrationError(message, path=str(path), column=f"real_{unit}")
    if f"imag_{unit}" not in columns:
        raise CalibrationError("missing", path=str(path), column=f"imag_{unit}")
    return unit


def _check_frequency(frequency: Floats, *, lines: Ints, path: Path) -> None:
    """Ascending, in a range that a tap excites."""
    steps = np.diff(frequency)
    if (steps <= 0.0).any():
        row = int(np.argmax(steps <= 0.0)) + 1
        message = f"{frequency[row]:g} Hz after {frequency[row - 1]:g} Hz; it must ascend"
        line = int(lines[row])
        raise CalibrationError(message, path=str(path), line=line, column=FREQUENCY)
    if frequency[0] < 0.0 or frequency[-1] > HIGHEST:
        row = 0 if frequency[0] < 0.0 else int(np.argmax(frequency > HIGHEST))
        message = f"{frequency[row]:g} Hz, expected 0 to {HIGHEST:g} Hz"
        line = int(lines[row])
        raise CalibrationError(message, path=str(path), line=line, column=FREQUENCY)
