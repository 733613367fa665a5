"""A kernel of every kind of argument, and a store of its own for each test."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

from simulator.kernels import store
from simulator.kernels.kernel import entry, kernel

FACTOR = 2.0


class Line(NamedTuple):
    """A straight line."""

    slope: float
    offset: float


@kernel
def height(line: Line, x: float) -> float:
    """Height of a line at x."""
    return FACTOR * (line.slope * x + line.offset)


@entry
def heights(line: Line, x: NDArray[np.float64], first: int, into: NDArray[np.float64]) -> None:
    """Write heights of a line from a row on."""
    for row in range(first, len(x)):
        into[row] = height(line, x[row])


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where machine code is kept; nowhere else."""
    monkeypatch.setattr(store, "PACKAGE_CACHE", tmp_path / "beside")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path / "beside"
