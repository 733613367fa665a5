"""What features remove together, and allowances."""

from collections.abc import Callable

import pytest

from stepnc_model.errors import SchemaError
from stepnc_model.toolpath.task import ToolPathTask
from stepnc_model.toolpath.turning.outline import outline_of
from stepnc_model.toolpath.turning.profile import HalfPlane
from stepnc_model.toolpath.turning.region import surface_of
from stepnc_model.toolpath.turning.setting import allowance_of, operation_of


def test_features_chain_into_one_surface(job: Callable[..., ToolPathTask]) -> None:
    at = job("ROUGH CONTOUR")
    surface = surface_of(
        tuple(outline_of(at, ref, 30.0) for ref in at.step.features), HalfPlane()
    )
    assert (surface.low, surface.high) == (-110.0, 0.0)
    assert [surface.at(z) for z in (-50.0, -90.0)] == [20.0, 27.0]


def test_an_allowance_is_not_negative(job: Callable[..., ToolPathTask]) -> None:
    at = job("ROUGH CONTOUR", ("#352,0.5)", "#352,-1.)"))
    with pytest.raises(SchemaError, match="allowance -1 mm"):
        allowance_of(at, at.step.operation_ref, at.step.operation)


def test_the_operation_of_a_lathe_is_needed(job: Callable[..., ToolPathTask]) -> None:
    assert operation_of(job("ROUGH CONTOUR")).its_id == "ROUGH CONTOUR"
