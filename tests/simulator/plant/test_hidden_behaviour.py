import pytest

from simulator.plant.hidden_behaviour import HiddenTruth
from tests.every_case import every_case


def test_a_machine_hides_nothing_when_nothing_is_said() -> None:
    hidden = HiddenTruth()
    assert hidden.force_factor == 1.0
    assert hidden.changes == ()


@every_case(
    ("name", "value"),
    [
        ("force_factor", 0.0),
        ("wear_rate", -1e-9),
        ("flank_wear", -0.1),
        ("eccentricity", -0.1),
        ("servo_lag", 0.0),
    ],
)
def test_impossible_numbers_are_refused(name: str, value: float) -> None:
    with pytest.raises(ValueError, match="must"):
        HiddenTruth(**{name: value})  # type: ignore[arg-type]
