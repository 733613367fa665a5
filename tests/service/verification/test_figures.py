"""Pictures of a verification show the greatest deviations."""

from pathlib import Path

import numpy as np
import pytest

from benchmarks.verification import found, offset
from service.verification.figures import MOST_POINTS, plan_figure, space_figure
from tests.service.verification.runs import REQUEST, fast_log, program


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
