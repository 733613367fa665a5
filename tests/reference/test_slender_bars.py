"""Bars between chuck and tailstock: cases of beams as handbooks print them.

AISC, "Steel Construction Manual", Table 3-23: cases 21 (cantilever, any point), 22 (free end),
13 (built in and supported, load in the middle) and 14 (the same, any point).
"""

from math import pi

import pytest
from hypothesis import given
from hypothesis import strategies as st

from simulator.physics.slender_bar import BarSection, compliance

STEEL, LENGTH, DIAMETER = 210_000.0, 300.0, 30.0
STIFFNESS = STEEL * pi * DIAMETER**4 / 64.0
"""E·I, N·mm²"""

WHOLE = (BarSection(start=0.0, end=LENGTH, outer=DIAMETER),)
PLACES = st.floats(0.01 * LENGTH, 0.99 * LENGTH)


def propped(at: float) -> float:
    return compliance(WHOLE, at, youngs_modulus=STEEL, centre=LENGTH)


def test_free_end_of_a_cantilever() -> None:
    """P·l³/(3·E·I)."""
    found = compliance(WHOLE, LENGTH, youngs_modulus=STEEL)
    assert found == pytest.approx(LENGTH**3 / (3.0 * STIFFNESS))


@given(place=PLACES)
def test_cantilever_at_any_point(place: float) -> None:
    """At the load, P·b³/(3·E·I)."""
    found = compliance(WHOLE, place, youngs_modulus=STEEL)
    assert found == pytest.approx(place**3 / (3.0 * STIFFNESS))


def test_middle_of_a_propped_bar() -> None:
    """7·P·l³/(768·E·I)."""
    assert propped(0.5 * LENGTH) == pytest.approx(7.0 * LENGTH**3 / (768.0 * STIFFNESS))


@given(place=PLACES)
def test_propped_bar_at_any_point(place: float) -> None:
    """At the load, P·a²·b³·(3·l + a)/(12·E·I·l³), a from the support and b from the wall."""
    free = LENGTH - place
    expected = free**2 * place**3 * (3.0 * LENGTH + free) / (12.0 * STIFFNESS * LENGTH**3)
    assert propped(place) == pytest.approx(expected, rel=1e-6)


def test_stepped_cantilever() -> None:
    """Half as thick from the middle on: the thin half alone, and the wall half below it."""
    thin = DIAMETER / 2.0
    halves = (
        BarSection(start=0.0, end=150.0, outer=DIAMETER),
        BarSection(start=150.0, end=300.0, outer=thin),
    )
    ratio = (DIAMETER / thin) ** 4
    expected = (300.0**3 - 150.0**3 + ratio * 150.0**3) / (3.0 * STIFFNESS)
    assert compliance(halves, 300.0, youngs_modulus=STEEL) == pytest.approx(expected)


@given(place=PLACES, cut=PLACES, centre=st.booleans())
def test_cutting_a_bar_into_sections_changes_nothing(
    place: float, cut: float, centre: bool
) -> None:
    parts = (
        BarSection(start=0.0, end=cut, outer=DIAMETER),
        BarSection(start=cut, end=LENGTH, outer=DIAMETER),
    )
    end = LENGTH if centre else None
    told = compliance(parts, place, youngs_modulus=STEEL, centre=end)
    whole = compliance(WHOLE, place, youngs_modulus=STEEL, centre=end)
    assert told == pytest.approx(whole, rel=1e-6, abs=1e-15)


@given(place=PLACES, bore=st.floats(0.0, 29.0))
def test_a_centre_helps_and_a_bore_does_not(place: float, bore: float) -> None:
    bored = (BarSection(start=0.0, end=LENGTH, outer=DIAMETER, inner=bore),)
    assert propped(place) <= compliance(WHOLE, place, youngs_modulus=STEEL)
    assert compliance(bored, place, youngs_modulus=STEEL) >= compliance(
        WHOLE, place, youngs_modulus=STEEL
    )


def test_what_is_cut_through_cannot_bend() -> None:
    gone = (BarSection(start=0.0, end=LENGTH, outer=10.0, inner=10.0),)
    with pytest.raises(ValueError, match="second moment of a bar 0 mm"):
        compliance(gone, LENGTH, youngs_modulus=STEEL)
    with pytest.raises(ValueError, match="Young's modulus 0 N/mm²"):
        compliance(WHOLE, LENGTH, youngs_modulus=0.0)
