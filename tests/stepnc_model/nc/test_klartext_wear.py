"""Wear that a tool call of Klartext states."""

from math import isnan

import pytest

from stepnc_model.nc.klartext_wear import with_wear
from stepnc_model.nc.klartext_words import klartext_words
from stepnc_model.nc.moves import ModalSetting

BEFORE = ModalSetting(tool=3, radius_wear=0.2, length_wear=-0.1)


@pytest.mark.parametrize(
    ("call", "scale", "radius", "length"),
    [
        ("5 TOOL CALL 5 Z S3000 DL+0.1 DR-0.05", 1.0, -0.05, 0.1),
        ("5 TOOL CALL 5 Z S3000 DR+0.002", 25.4, 0.0508, 0.0),
        ("5 TOOL CALL 5 Z S3000", 1.0, 0.0, 0.0),
        ("5 TOOL CALL S2000", 1.0, 0.2, -0.1),
        ("5 TOOL CALL S2000 DL+0.3", 1.0, 0.2, 0.3),
    ],
)
def test_a_call_of_a_tool_states_its_wear_anew(
    call: str, scale: float, radius: float, length: float
) -> None:
    found = with_wear(BEFORE, klartext_words(call), scale=scale)
    assert (found.radius_wear, found.length_wear) == pytest.approx((radius, length))


def test_wear_from_a_variable_is_not_known() -> None:
    found = with_wear(BEFORE, klartext_words("5 TOOL CALL 5 Z S3000 DRQ5 DL+0.1"), scale=1.0)
    assert isnan(found.radius_wear)
    assert found.length_wear == 0.1
