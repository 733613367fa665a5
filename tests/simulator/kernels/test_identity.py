"""Machine code is found only for the very same kernel."""

from types import FunctionType
from typing import Any

import pytest

from simulator.kernels import link
from simulator.kernels import store as identity
from tests.simulator.kernels import conftest
from tests.simulator.kernels.conftest import Line, height, heights

BEFORE = identity.digest(heights.function, "types")


def digest() -> str:
    return identity.digest(heights.function, "types")


def test_a_digest_stays() -> None:
    assert digest() == BEFORE


def test_other_types_are_another_kernel() -> None:
    assert identity.digest(heights.function, "other types") != BEFORE


def test_a_constant_of_a_called_kernel_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(conftest, "FACTOR", 3.0)
    assert digest() != BEFORE


def test_the_code_of_a_called_kernel_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    def other(line: Line, x: float) -> float:
        """Height of a line at x."""
        return conftest.FACTOR * (line.offset + line.slope * x)

    other.is_kernel = True  # type: ignore[attr-defined]
    monkeypatch.setattr(conftest, "height", other)
    assert digest() != BEFORE


def test_lines_of_the_file_do_not_count(monkeypatch: pytest.MonkeyPatch) -> None:
    code = height.__code__.replace(co_firstlineno=999, co_filename="elsewhere.py")
    moved: Any = FunctionType(code, height.__globals__, height.__name__)
    moved.is_kernel = True
    monkeypatch.setattr(conftest, "height", moved)
    assert digest() == BEFORE


@pytest.mark.parametrize("name", ["version", "processor"])
def test_versions_and_processor_count(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    if name == "version":
        monkeypatch.setattr(identity, "version", lambda _: "0")
    else:
        monkeypatch.setattr(link, "processor", lambda: ("none", "none", ""))
    assert digest() != BEFORE


def test_the_order_of_sums_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(height, "is_reordered", True, raising=False)
    assert digest() != BEFORE
