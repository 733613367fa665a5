"""Designs: the same rows whatever the length, and the coverage that each kind promises."""

import numpy as np
import pytest

from extras.factory.model.design import BLOCK, DesignKind, ExperimentDesign, FactorRange

FEED, SPEED, DEPTH = (
    FactorRange(low=30.0, high=90.0),
    FactorRange(low=12.0, high=36.0),
    FactorRange(low=2.5, high=3.5),
)


def design(kind: DesignKind, *, levels: int = 1, seed: int = 3) -> ExperimentDesign:
    return ExperimentDesign(
        kind=kind, seed=seed, machines=2, feed=FEED, spindle_speed=SPEED, depth=DEPTH,
        levels=levels,
    )  # fmt: skip


@pytest.mark.parametrize("kind", list(DesignKind))
def test_a_row_depends_on_its_number_alone(kind: DesignKind) -> None:
    made = design(kind, levels=6)
    rows = list(made.rows(0, 250))
    assert [each.number for each in rows] == list(range(250))
    assert list(made.rows(120, 230)) == rows[120:230]


@pytest.mark.parametrize("kind", [DesignKind.UNIFORM, DesignKind.LATIN_HYPERCUBE])
def test_another_seed_gives_other_rows(kind: DesignKind) -> None:
    rows, others = (list(design(kind, seed=seed).rows(0, 5)) for seed in (1, 2))
    assert all(row.settings != other.settings for row, other in zip(rows, others, strict=True))


def test_uniform_rows_fill_the_ranges() -> None:
    rows = list(design(DesignKind.UNIFORM).rows(0, 2000))
    feeds = np.array([row.settings.cut.feed for row in rows])
    speeds = np.array([row.settings.cut.spindle_speed for row in rows])
    assert 30.0 <= feeds.min() < 30.2
    assert 89.8 < feeds.max() <= 90.0
    assert feeds.mean() == pytest.approx(60.0, abs=4 * 60.0 / np.sqrt(12 * 2000))
    assert speeds.min() >= -36.0
    assert speeds.max() <= -12.0, "clockwise is negative"
    assert abs(np.corrcoef(feeds, speeds)[0, 1]) < 4 / np.sqrt(2000)
    assert np.mean([row.machine for row in rows]) == pytest.approx(0.5, abs=0.05)


def test_latin_hypercube_takes_each_part_of_a_range_once_a_block() -> None:
    rows = list(design(DesignKind.LATIN_HYPERCUBE).rows(BLOCK, 2 * BLOCK))
    for name, within in (("feed", FEED), ("depth", DEPTH)):
        values = np.array([getattr(row.settings.cut, name) for row in rows])
        parts = np.floor(BLOCK * (values - within.low) / (within.high - within.low))
        assert sorted(parts) == list(range(BLOCK))
    assert sum(row.machine for row in rows) == BLOCK // 2


def test_full_factorial_is_every_combination_once() -> None:
    made = design(DesignKind.FULL_FACTORIAL, levels=3)
    assert made.size == 2 * 3**3
    rows = list(made.rows(0, 54))
    assert len({(row.machine, row.settings) for row in rows}) == 54
    assert {row.settings.cut.feed for row in rows} == {30.0, 60.0, 90.0}
    assert {row.settings.cut.depth for row in rows} == {2.5, 3.0, 3.5}
    with pytest.raises(ValueError, match="55 rows exceed 54, all combinations"):
        list(made.rows(0, 55))


def test_settings_that_do_not_vary_stay_those_of_the_program() -> None:
    made = ExperimentDesign(kind=DesignKind.UNIFORM, seed=1, feed=FEED)
    (row,) = made.rows(0, 1)
    assert row.settings.cut.spindle_speed is None
    assert row.settings.cut.depth is None
    assert made.size is None
    assert [each.cut.feed for each in made.ends] == [30.0, 90.0]
