"""Forces along the helix against thin discs, closed forms and means; what runout does."""

from dataclasses import replace
from math import atan, cos, pi, radians, sin, tan

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from optimiser.cuts.hardest_places import LIKELY
from simulator.physics import engagement
from simulator.physics.engagement import Engagement
from simulator.physics.flutes import WALL, CuttingEdges, ForceLaw
from simulator.physics.milling import MillingCut, mean_force
from simulator.physics.tooth_forces import (
    STRAIGHT,
    Floats,
    Forces,
    Places,
    arcs_of,
    forces,
    one_place,
    peak_resultant,
    wall_force,
)
from simulator.spec import Kienzle
from tests.every_case import every_case
from tests.simulator.physics.discs import RADIAL, Mill

LINEAR = ForceLaw(exponent=1.0)
STEEL_LAW = ForceLaw(exponent=0.78)
STEEL = Kienzle(k_c11=1500.0, m_c=0.22)
ARCS = [
    engagement.full_immersion(),
    engagement.unidirectional(2.0, 10.0),
    engagement.conventional(3.0, 10.0),
    engagement.bilateral(6.0, 10.0, offset=1.0),
]
HELIX = radians(30.0)


def edges_of(mill: Mill) -> CuttingEdges:
    return CuttingEdges(
        teeth=mill.teeth,
        diameter=mill.diameter,
        helix_angle=mill.helix,
        corner_radius=mill.corner,
    )


def place(entry: float, exit_: float, depth: float) -> Places:
    return one_place(entry, exit_, axial_depth=depth)


def place_of(mill: Mill) -> Places:
    return place(mill.entry, mill.exit, mill.depth)


def turned(mill: Mill, rotation: Floats) -> Forces:
    law = ForceLaw(exponent=mill.exponent)
    return forces(edges_of(mill), place_of(mill), law, rotation=rotation[None, :])


def peak(mill: Mill) -> float:
    return float(
        peak_resultant(edges_of(mill), place_of(mill), ForceLaw(exponent=mill.exponent))[0]
    )


def wall(mill: Mill) -> float:
    return float(
        wall_force(edges_of(mill), place_of(mill), ForceLaw(exponent=mill.exponent))[0]
    )


@st.composite
def mills(draw: st.DrawFn) -> Mill:
    diameter = draw(st.sampled_from([1.0, 6.0, 12.0, 20.0, 50.0]))
    contact = draw(st.floats(0.05, pi))
    side = draw(st.sampled_from(["climb", "conventional", "between"]))
    entry = {"climb": pi - contact, "conventional": 0.0}.get(
        side, draw(st.floats(0.0, 1.0)) * (pi - contact)
    )
    return Mill(
        teeth=draw(st.integers(1, 8)),
        diameter=diameter,
        helix=draw(st.sampled_from([0.0, 0.02, 0.2, HELIX, 0.8, 1.05])),
        entry=entry,
        exit=entry + contact,
        depth=diameter * draw(st.floats(0.01, 2.0)),
        exponent=draw(st.sampled_from([0.65, 0.78, 1.0])),
    )


@settings(max_examples=40)
@given(mills(), st.floats(0.0, 2.0 * pi))
def test_forces_are_those_of_thin_discs(mill: Mill, rotation: float) -> None:
    at = np.array([rotation])
    found = turned(mill, at)
    scale = max(peak(mill), 1e-3)
    # A disc more or less is in the cut of each tooth; a straight edge enters all at once.
    ends = np.mod(rotation - np.array([mill.entry, mill.exit]), mill.pitch)
    if mill.helix == 0.0:
        assume(np.minimum(ends, mill.pitch - ends).min() > 1e-5)
    for ours, discs in zip(
        (found.tangential, found.feed, found.normal), mill.forces(at), strict=True
    ):
        assert ours[0, 0] == pytest.approx(discs[0], abs=0.01 * scale)


@settings(max_examples=40)
@given(mills())
def test_peak_is_that_of_thin_discs(mill: Mill) -> None:
    assert peak(mill) == pytest.approx(mill.peak(), rel=0.01)


@settings(max_examples=40)
@given(mills())
def test_wall_force_is_that_of_thin_discs_at_the_moments_when_they_make_it(mill: Mill) -> None:
    assume(mill.helix > 0.0)
    angles = [0.0] if mill.entry <= WALL else []
    if mill.exit >= pi - WALL:
        angles.append(pi)
    if not angles:
        assert wall(mill) == 0.0
        return
    expected = max(mill.wall(angle) for angle in angles)
    assert wall(mill) == pytest.approx(expected, rel=0.01, abs=5e-3 * peak(mill))


@every_case("teeth", [1, 2, 3, 4, 5, 8])
@every_case("exponent", [0.78, 1.0])
@every_case("arc", ARCS)
def test_straight_edges_take_the_sum_of_their_chips(
    teeth: int, exponent: float, arc: Engagement
) -> None:
    """Σ sin^q φ_j over the teeth on the arc."""
    mill = Mill(
        teeth=teeth,
        diameter=10.0,
        helix=0.0,
        entry=arc.entry_angle,
        exit=arc.exit_angle,
        depth=2.0,
        exponent=exponent,
    )
    rotation = np.linspace(0.011, 2.0 * pi, 50)
    found = turned(mill, rotation).tangential[0]
    for turn, force in zip(rotation.tolist(), found.tolist(), strict=True):
        angles = [(turn - tooth * mill.pitch) % (2.0 * pi) for tooth in range(teeth)]
        chips = [sin(a) for a in angles if arc.entry_angle < a < arc.exit_angle]
        assert force == pytest.approx(2.0 * sum(chip**exponent for chip in chips), abs=2e-5)


def test_a_helix_that_goes_to_nothing_is_a_straight_edge() -> None:
    straight = Mill(
        teeth=3, diameter=10.0, helix=0.0, entry=1.9, exit=pi, depth=5.0, exponent=0.78
    )
    rotation = np.array([0.1, 0.7, 1.5, 2.0, 2.9])
    nearly = replace(straight, helix=1e-9)
    for ours, other in (
        (turned(straight, rotation), turned(nearly, rotation)),
        (turned(straight, rotation), turned(replace(straight, helix=1e-5), rotation)),
    ):
        np.testing.assert_allclose(ours.tangential, other.tangential, atol=1e-3)
    assert peak(nearly) == pytest.approx(peak(straight), rel=1e-3)
    assert wall(straight) < 1e-3 * peak(straight)


@every_case("teeth", [1, 2, 4, 6])
@every_case("arc", ARCS)
def test_in_one_axial_pitch_of_depth_the_force_stays_the_same(
    teeth: int, arc: Engagement
) -> None:
    """a_p = 2πR/(z·tan λ): what leaves above enters below; it is the mean, worked by hand."""
    mill = Mill(
        teeth=teeth,
        diameter=10.0,
        helix=HELIX,
        entry=arc.entry_angle,
        exit=arc.exit_angle,
        depth=pi * 10.0 / (teeth * tan(HELIX)),
        exponent=1.0,
    )
    found = turned(mill, np.linspace(0.0, 2.0 * pi, 101))
    mean = teeth / (2.0 * pi) * mill.depth * arc.cosine_difference
    np.testing.assert_allclose(found.tangential, mean, rtol=1e-5)
    np.testing.assert_allclose(found.normal, found.normal[0, 0], atol=1e-5 * mean)
    assert peak(mill) == pytest.approx(found.resultant[0, 0], rel=1e-5)


def test_a_whole_helical_tooth_in_the_cut_has_its_closed_form() -> None:
    """From the top to the tip: ∫sin dφ, ∫sin·cos dφ, ∫sin² dφ over the lag per mm."""
    mill = Mill(
        teeth=1, diameter=12.0, helix=HELIX, entry=0.0, exit=pi, depth=6.0, exponent=1.0
    )
    lag = tan(HELIX) / 6.0
    tip = 2.0
    top = tip - 6.0 * lag
    shear = (np.cos(top) - np.cos(tip)) / lag
    across = 0.5 * (np.sin(tip) ** 2 - np.sin(top) ** 2) / lag
    squared = 0.5 * (tip - top - np.sin(tip) * np.cos(tip) + np.sin(top) * np.cos(top)) / lag
    found = turned(mill, np.array([tip]))
    assert found.tangential[0, 0] == pytest.approx(shear, rel=1e-9)
    assert found.feed[0, 0] == pytest.approx(across + RADIAL * squared, rel=1e-9)
    assert found.normal[0, 0] == pytest.approx(squared - RADIAL * across, rel=1e-9)


@every_case("exponent", [0.65, 0.78, 1.0])
@every_case("share", [0.1, 0.5, 1.0, 1.6])
def test_a_ball_is_that_of_thin_slices(exponent: float, share: float) -> None:
    mill = Mill(
        teeth=2,
        diameter=10.0,
        helix=HELIX,
        entry=1.2,
        exit=pi,
        depth=5.0 * share,
        exponent=exponent,
        corner=5.0,
    )
    rotation = np.linspace(0.0, pi, 41)
    found, discs = turned(mill, rotation), mill.forces(rotation)
    for ours, other in zip((found.tangential, found.feed, found.normal), discs, strict=True):
        np.testing.assert_allclose(ours[0], other, atol=0.02 * peak(mill))
    assert peak(mill) == pytest.approx(mill.peak(), rel=0.02)


def test_a_straight_ball_has_its_closed_form() -> None:
    """Linear law at φ = 90°: F_t = r·∫sin θ dθ = r, and F_r = 0.3·r·∫sin² θ dθ = 0.3·r·π/4."""
    mill = Mill(
        teeth=1,
        diameter=10.0,
        helix=0.0,
        entry=0.0,
        exit=pi,
        depth=5.0,
        exponent=1.0,
        corner=5.0,
    )
    found = turned(mill, np.array([0.5 * pi]))
    assert found.tangential[0, 0] == pytest.approx(5.0, rel=0.01)
    assert found.feed[0, 0] == pytest.approx(0.3 * 5.0 * pi / 4.0, rel=0.01)


@every_case("arc", ARCS)
@every_case("teeth", [1, 3, 4])
@every_case("helix", [0.0, HELIX, 1.0])
@every_case("kappa", [pi / 2.0, pi / 4.0])
def test_the_mean_over_a_revolution_is_the_mean_force_of_a_linear_law(
    arc: Engagement, teeth: int, helix: float, kappa: float
) -> None:
    edges = CuttingEdges(
        teeth=teeth, diameter=10.0, helix_angle=helix, cutting_edge_angle=kappa
    )
    rotation, weights = revolution(arc, teeth, lag=7.0 * edges.lag)
    at = place(arc.entry_angle, arc.exit_angle, 7.0)
    found = forces(edges, at, LINEAR, rotation=rotation[None, :])
    share, radial = teeth * 7.0 / (2.0 * pi), RADIAL * sin(kappa)
    tangential, feed, normal = (
        share * quad(force, arc.entry_angle, arc.exit_angle)[0]
        for force in (
            sin,
            lambda angle: sin(angle) * (cos(angle) + radial * sin(angle)),
            lambda angle: sin(angle) * (sin(angle) - radial * cos(angle)),
        )
    )
    tolerance = 1e-5 * tangential
    assert found.tangential[0] @ weights == pytest.approx(tangential, abs=tolerance)
    assert found.feed[0] @ weights == pytest.approx(feed, abs=tolerance)
    assert found.normal[0] @ weights == pytest.approx(normal, abs=tolerance)
    cut = MillingCut(
        feed_per_tooth=1.0,
        teeth=teeth,
        axial_depth=7.0,
        engagement=arc,
        cutting_edge_angle=kappa,
    )
    assert mean_force(Kienzle(k_c11=1.0, m_c=0.0), cut) == pytest.approx(tangential)


@pytest.mark.parametrize("helix", [0.0, HELIX])
def test_means_of_a_slot_in_print(helix: float) -> None:
    """Altintas, slotting: mean of F_x is N·a·c·K_r/4 and that of F_y N·a·c·K_t/4."""
    edges, arc = CuttingEdges(teeth=4, diameter=10.0, helix_angle=helix), ARCS[0]
    rotation, weights = revolution(arc, 4, lag=2.0 * edges.lag)
    found = forces(edges, place(0.0, pi, 2.0), LINEAR, rotation=rotation[None, :])
    assert found.feed[0] @ weights == pytest.approx(4 * 2.0 * RADIAL / 4.0, rel=1e-5)
    assert found.normal[0] @ weights == pytest.approx(4 * 2.0 / 4.0, rel=1e-5)


def revolution(arc: Engagement, teeth: int, *, lag: float) -> tuple[Floats, Floats]:
    """Nodes and weights that average over one turn: Gauss between all entries and exits."""
    lag = max(lag, STRAIGHT)
    ends = [
        np.mod(angle + tooth * 2.0 * pi / teeth, 2.0 * pi)
        for end in (arc.entry_angle, arc.exit_angle)
        for angle in (end, end + lag)
        for tooth in range(teeth)
    ]
    each = np.unique(np.concatenate(([0.0, 2.0 * pi], ends)))
    nodes, weights = np.polynomial.legendre.leggauss(16)
    half = np.diff(each)[:, None] / 2.0
    return (each[:-1, None] + half * (1.0 + nodes)).ravel(), (
        half * weights / (2.0 * pi)
    ).ravel()


def test_peak_force_of_a_finish_is_that_of_its_helix() -> None:
    """Contour with D 20, a_p 20: of the thin arc only 1/8 of the edge is in the cut at once.

    Straight edges said 8.3 times as much at a_e 0.3; 7.4 times at the 0.37 mm that the path
    meets in the part.
    """
    ratios = []
    for width in (0.3, 0.37):
        arc = engagement.unidirectional(width, 20.0)
        straight = Mill(
            teeth=4,
            diameter=20.0,
            helix=0.0,
            entry=arc.entry_angle,
            exit=pi,
            depth=20.0,
            exponent=0.78,
        )
        twisted = replace(straight, helix=HELIX)
        whole = 20.0 * sin(arc.entry_angle) ** 0.78
        lag = 2.0 * tan(HELIX)
        rotation = pi - 0.5 + np.linspace(0.0, 0.5 + lag, 400)
        found = turned(twisted, rotation).tangential.max()
        assert found == pytest.approx(twisted.forces(rotation)[0].max(), rel=0.01)
        ratios.append(whole / found)
        assert peak(straight) / peak(twisted) == pytest.approx(whole / found, rel=0.01)
    assert ratios == pytest.approx([8.3, 7.4], rel=0.015)


def test_a_straight_edge_makes_its_wall_without_a_chip() -> None:
    mill = Mill(
        teeth=2, diameter=20.0, helix=0.0, entry=2.8, exit=pi, depth=20.0, exponent=0.78
    )
    assert wall(mill) < 1e-3
    assert wall(replace(mill, helix=HELIX)) > 0.1


def test_integrals_over_arcs_are_those_of_quadrature() -> None:
    table = arcs_of(
        np.array([arc.entry_angle for arc in ARCS]), np.array([arc.exit_angle for arc in ARCS])
    )
    integrands = {
        "contact": lambda angle: 1.0,
        "sine": sin,
        "cosine": cos,
        "sine_squared": lambda angle: sin(angle) ** 2,
        "sine_cosine": lambda angle: sin(angle) * cos(angle),
    }
    for row, arc in enumerate(ARCS):
        for name, integrand in integrands.items():
            expected = quad(integrand, arc.entry_angle, arc.exit_angle)[0]
            assert getattr(table, name)[row] == pytest.approx(expected, abs=1e-12)


def test_places_together_are_as_each_by_itself() -> None:
    edges = CuttingEdges(teeth=3, diameter=12.0, helix_angle=HELIX, corner_radius=1.0)
    law = ForceLaw(exponent=0.78)
    each = [place(arc.entry_angle, arc.exit_angle, 2.0 + row) for row, arc in enumerate(ARCS)]
    columns = ("entry_angle", "exit_angle", "axial_depth")
    whole = Places(**{
        name: np.concatenate([getattr(one, name) for one in each]) for name in columns
    })
    for of in (peak_resultant, wall_force):
        together = of(edges, whole, law)
        assert together == pytest.approx([float(of(edges, one, law)[0]) for one in each])


@settings(max_examples=40)
@given(
    teeth=st.integers(1, 6),
    helix=st.floats(0.0, 0.9),
    exit_=st.floats(0.1, pi),
    contact=st.floats(0.05, pi),
    depth=st.floats(0.1, 60.0),
)
def test_a_rough_look_is_never_above_and_finds_most(
    teeth: int, helix: float, exit_: float, contact: float, depth: float
) -> None:
    """What is less than a share of the roughly greatest is not looked at again."""
    edges = CuttingEdges(teeth=teeth, diameter=20.0, helix_angle=helix)
    for end in (exit_, pi):
        at = place(max(end - contact, 0.0), end, depth)
        for of in (peak_resultant, wall_force):
            rough, exact = (
                float(of(edges, at, STEEL_LAW, is_rough=r)[0]) for r in (True, False)
            )
            assert LIKELY * exact <= rough <= exact * (1.0 + 1e-9)


def test_a_helix_out_of_range_is_refused() -> None:
    with pytest.raises(ValueError, match=r"helix angle 1\.6 rad"):
        CuttingEdges(teeth=2, diameter=10.0, helix_angle=1.6)


def test_the_lag_is_that_of_a_constant_lead() -> None:
    edges = CuttingEdges(teeth=2, diameter=10.0, helix_angle=atan(0.5))
    assert edges.lag == pytest.approx(0.1)
    assert edges.pitch == pytest.approx(pi)
