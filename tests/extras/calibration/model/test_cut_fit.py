"""Laws of cuts: found again where the truth is made, honest where it is not seen."""

from dataclasses import replace
from math import exp, log

import numpy as np
import pytest

from extras.calibration.model.cut_fit import (
    fitted_law,
    left_out,
    predictions,
    rows_of,
    skill_of,
)
from extras.calibration.model.cut_laws import LawKind
from extras.calibration.model.cut_table import CutRow
from simulator.library import load_material
from simulator.spec import CuttingMaterial
from stepnc_model.errors import Finding

EDGE = CuttingMaterial.CARBIDE
C45 = load_material("c45")


def _cut(**numbers: float) -> CutRow:
    return CutRow(line=1, words={}, numbers=numbers)


def _force(feed: float, *, factor: float, exponent: float = 0.23, depth: float = 2.0) -> CutRow:
    """Row of a made shop, whose k_c at 0.2 mm is a multiple of the catalogue's."""
    specific = factor * 1500.0 * 0.2**-0.22 * (feed / 0.2) ** -exponent
    return _cut(feed_mm=feed, axial_depth_mm=depth, cutting_force_n=specific * feed * depth)


@pytest.mark.parametrize("factor", [0.39, 2.6])
def test_a_shop_far_from_the_catalogue_is_accepted_after_three_cuts(factor: float) -> None:
    rows = [_force(feed, factor=factor) for feed in (0.1, 0.2, 0.3)]
    fit = fitted_law(LawKind.FORCES, C45, rows, edge=EDGE)
    (found,) = predictions(fit, [_force(0.25, factor=factor)])
    assert found.predicted == pytest.approx(found.measured, rel=0.05)
    assert all(weight > 0.9 for weight in fit.posterior.weights)


def test_one_feed_leaves_the_exponent_at_its_prior() -> None:
    rows = [_force(feed, factor=1.1) for feed in (0.098, 0.1, 0.102)]
    rows[1] = replace(
        rows[1],
        numbers={
            **rows[1].numbers,
            "cutting_force_n": 1.03 * rows[1].numbers["cutting_force_n"],
        },
    )
    fit = fitted_law(LawKind.FORCES, C45, rows, edge=EDGE)
    assert fit.posterior.mean[1] == pytest.approx(0.23, abs=0.02)
    assert fit.posterior.learned[1] < 0.1


def test_an_outlier_counts_less_and_does_not_move_the_law() -> None:
    rows = [_force(feed, factor=1.0) for feed in (0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4)]
    wrong = replace(
        rows[3],
        numbers={
            **rows[3].numbers,
            "cutting_force_n": 2.0 * rows[3].numbers["cutting_force_n"],
        },
    )
    fit = fitted_law(LawKind.FORCES, C45, [*rows[:3], wrong, *rows[4:]], edge=EDGE)
    assert fit.posterior.weights[3] < 0.5
    (found,) = predictions(fit, [rows[3]])
    assert found.predicted == pytest.approx(found.measured, rel=0.05)


def test_intervals_widen_outside_the_measured_chips() -> None:
    fit = fitted_law(
        LawKind.FORCES, C45, [_force(f, factor=1.0) for f in (0.1, 0.15, 0.2)], edge=EDGE
    )
    near, far = predictions(fit, [_force(0.15, factor=1.0), _force(0.6, factor=1.0)])
    assert far.high / far.low > near.high / near.low


def test_an_edge_that_stopped_unworn_lengthens_the_life() -> None:
    cut = {"cutting_speed_m_min": 200.0, "feed_mm": 0.2, "axial_depth_mm": 2.0}
    lives = [_cut(**cut, life_min=life) for life in (20.0, 25.0)]
    stopped = _cut(**cut, time_min=40.0)
    alone = fitted_law(LawKind.LIFE, C45, lives, edge=EDGE)
    both = fitted_law(LawKind.LIFE, C45, [*lives, stopped], edge=EDGE)
    assert (
        predictions(both, lives[:1])[0].predicted > predictions(alone, lives[:1])[0].predicted
    )


def test_one_speed_leaves_taylors_exponent_at_its_prior() -> None:
    cut = {"cutting_speed_m_min": 200.0, "feed_mm": 0.2, "axial_depth_mm": 2.0}
    rows = [_cut(**cut, life_min=life) for life in (20.0, 25.0, 22.0)]
    fit = fitted_law(LawKind.LIFE, C45, rows, edge=EDGE)
    assert fit.posterior.learned[1] < 0.1
    same, faster = predictions(fit, [rows[0], _cut(**{**cut, "cutting_speed_m_min": 300.0},
                                                   life_min=5.0)])  # fmt: skip
    assert faster.high / faster.low > same.high / same.low


def test_wear_readings_become_lives_and_a_single_one_is_told() -> None:
    def reading(edge: str, time: float, wear: float) -> CutRow:
        numbers = {"cutting_speed_m_min": 200.0, "time_min": time, "flank_wear_mm": wear}
        return CutRow(line=1, words={"edge": edge}, numbers=numbers)

    findings: list[Finding] = []
    worn, stopped = rows_of(
        LawKind.LIFE,
        [
            reading("A", 10.0, 0.2), reading("A", 20.0, 0.4), reading("B", 10.0, 0.1),
            reading("B", 20.0, 0.2), reading("C", 5.0, 0.1),
        ],
        criterion=0.3, findings=findings,
    )  # fmt: skip
    assert worn.number("life_min") == pytest.approx(15.0)
    assert stopped.number("life_min") is None
    assert stopped.number("time_min") == 20.0
    assert "edge C" in findings[0].message


def test_forces_of_milling_are_not_taken_for_cutting_forces() -> None:
    findings: list[Finding] = []
    row = CutRow(
        line=3, words={"operation": "milling"}, numbers={"feed_mm": 0.1, "cutting_force_n": 9.0}
    )
    assert not rows_of(LawKind.FORCES, [row], criterion=0.3, findings=findings)
    assert findings[0].line == 3


def test_roughness_learns_a_floor_that_the_feed_does_not_explain() -> None:
    rng = np.random.default_rng(1)
    rows = [
        _cut(
            feed_mm=feed, nose_radius_mm=0.8, cutting_speed_m_min=150.0,
            ra_um=(0.6 * 32.075 * feed**2 / 0.8 + 1.4) * exp(0.1 * rng.standard_normal()),
        )
        for feed in (0.05, 0.1, 0.15, 0.2, 0.25, 0.3)
    ]  # fmt: skip
    fit = fitted_law(LawKind.ROUGHNESS, C45, rows, edge=EDGE)
    assert exp(fit.posterior.mean[1]) == pytest.approx(1.4, rel=0.25)
    skill = skill_of(left_out(LawKind.ROUGHNESS, C45, rows, edge=EDGE))
    assert skill is not None
    assert skill.skill > 0.5
    assert not skill.is_worse


def test_made_truth_lies_inside_its_intervals_as_often_as_they_say() -> None:
    """Draws from the prior of k₀ and m, 4 readings each: 90 % intervals of both."""
    rng = np.random.default_rng(7)
    prior = fitted_law(LawKind.FORCES, C45, (), edge=EDGE).posterior.prior
    inside = []
    for _ in range(40):
        level, exponent = prior.mean[:2] + prior.sd[:2] * rng.standard_normal(2)
        rows = [
            _cut(feed_mm=feed, specific_cutting_force_n_mm2=exp(
                level - exponent * log(feed / 0.2) + 0.03 * rng.standard_normal()))
            for feed in (0.1, 0.15, 0.2, 0.3)
        ]  # fmt: skip
        found = fitted_law(LawKind.FORCES, C45, rows, edge=EDGE).posterior
        away = np.abs(found.mean[:2] - (level, exponent)) / np.sqrt(
            np.diag(found.covariance)[:2]
        )
        inside += [each < 1.645 for each in away]
    assert 0.8 <= np.mean(inside) <= 0.98
