"""Pictures of a verification show the greatest deviations."""

from pathlib import Path

import numpy as np
import pytest

from benchmarks.verification import SHAFT_REQUEST, found, offset
from extras.verification.figures import MOST_POINTS, plan_figure, space_figure
from extras.verification.run import verified
from tests.extras.verification.runs import REQUEST, fast_log, program, shaft, shaft_log


def test_the_greatest_deviation_is_in_the_plan(tmp_path: Path) -> None:
    answer = found(offset(0.3), fast_log(), program(), folder=tmp_path, request=REQUEST)
    floors, walls = plan_figure(answer.verification).data
    greatest = np.abs(answer.verification.places.deviation).max()
    assert np.abs(walls.marker.color).max() == pytest.approx(greatest)
    assert walls.marker.cmax == pytest.approx(-walls.marker.cmin)
    assert floors.zmax == walls.marker.cmax
    # Served reports may not compile functions from text, as WebGL traces in a plane do.
    assert {floors.type, walls.type} == {"heatmap", "scatter"}
    (points,) = space_figure(answer.verification).data
    assert len(points.x) <= MOST_POINTS


def test_a_turned_part_is_round_in_space(tmp_path: Path) -> None:
    moved = offset(0.15, "FINISH CONTOUR").make(shaft_log(), shaft())
    log = moved.write(tmp_path / "log.parquet", shaft())
    figure = space_figure(verified(log, shaft(), SHAFT_REQUEST))
    (points,) = figure.data
    shape = figure.layout.scene.aspectratio
    assert shape.z == 1.0
    assert shape.x == pytest.approx(np.ptp(points.x) / np.ptp(points.z))
    assert len(points.x) <= MOST_POINTS
    assert points.x.min() == pytest.approx(-points.x.max(), rel=0.01)
    assert points.y.max() == pytest.approx(points.x.max(), rel=0.01)
    assert np.abs(points.marker.color).max() >= 0.15 - 1e-6
