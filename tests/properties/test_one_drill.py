"""Plan and virtual machine tell the same drill by every figure."""

from dataclasses import replace
from math import pi, radians, sin

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from optimiser.bounds import loads
from optimiser.bounds.limits import drill_point, force_factor, force_load
from simulator.machine.cutting import CuttingEdge, cutting_loads
from simulator.removal.stations import StationKind, Stations
from tests.optimiser.sample_cuts import DRILLED, conditions

AT = conditions(DRILLED.tool_kind)


@settings(max_examples=50)
@given(
    feed=st.floats(0.02, 0.3),
    diameter=st.floats(2.0, 30.0),
    share=st.sampled_from([0.0, 0.05, 0.3, 0.8]),
    speed=st.floats(5.0, 100.0),
)
def test_force_thrust_and_power_of_a_hole_are_the_same_on_both_sides(
    feed: float, diameter: float, share: float, speed: float
) -> None:
    """In the solid, in a hole narrower than the chisel edge, and in a wider one."""
    hole = share * diameter
    cut = replace(DRILLED, diameter=diameter, previous_diameter=hole)
    point, half = drill_point(AT), 0.5 * (cut.tool.point_angle or radians(118.0))
    column = {
        "section": 0.25 * pi * (diameter**2 - hole**2),
        "axial_depth": 0.5 * (diameter - hole),
        "chip_ratio": sin(half),
        "diameter": 0.5 * (diameter + hole),
    }
    none = ("growth", "radial_width", "entry_angle", "exit_angle", "contact_angle")
    stations = Stations(
        segment=np.array([0]),
        station=np.array([1.0]),
        kind=np.array([int(StationKind.DRILLING)]),
        **{name: np.array([value]) for name, value in column.items()},
        **{name: np.zeros(1) for name in none},
    )
    teeth = cut.tool.teeth
    machine = cutting_loads(
        stations,
        np.array([0]),
        speed=np.array([feed * teeth * speed]),
        spindle_speed=np.array([speed]),
        edge=CuttingEdge(
            teeth=teeth, kienzle=AT.material.kienzle, factor=force_factor(AT), point=point
        ),
    )
    force = force_load(cut, AT)
    thrust = loads.thrust(cut, AT.material.kienzle, force_factor(AT), point)
    power = loads.motor_power(cut, force, efficiency=1.0)
    for planned, run in (
        (force, machine.force),
        (thrust, machine.feed_force),
        (power, machine.power),
    ):
        assert run[0] == pytest.approx(planned.value(feed, 1.0, speed))
