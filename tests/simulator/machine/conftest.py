"""A mill and a lathe with round numbers, and a stock that is the same everywhere."""

from collections.abc import Callable
from dataclasses import fields, replace
from math import pi

import numpy as np
import pytest
from numpy.typing import NDArray

from simulator.machine.samples import Samples
from simulator.motion.segments import Segments
from simulator.removal.collision import Collision
from simulator.removal.cutter import Cutter, Insert
from simulator.removal.stations import StationKind, Stations
from simulator.spec import Axis, AxisDrive, Machine, MachineKind, Spindle, SpindlePoint

THREES = ("position", "velocity", "axis_power")

EVENTS = ("execution", "path_mode", "coolant", "overload", "line", "tool", "workingstep")

WHOLE = dict.fromkeys(EVENTS, np.int64)


@pytest.fixture(scope="session")
def mill() -> Machine:
    drive = AxisDrive(
        lead=10.0,
        table_mass=200.0,
        screw_mass=5.0,
        screw_diameter=30.0,
        guide_friction=0.02,
        viscous=2.0,
        efficiency=0.9,
    )
    return Machine(
        name="round",
        title="Round mill",
        kind=MachineKind.MILL,
        spindle=Spindle(
            curve=(SpindlePoint(speed=25.0, power=5000.0, torque=20_000.0),),
            efficiency=0.8,
            min_speed=None,
            max_speed=200.0,
            acceleration=50.0,
            inertia=0.01,
            idle_power=100.0,
            idle_power_per_speed=2.0,
            idle_power_per_speed_squared=0.01,
        ),
        axes=tuple(
            Axis(
                name=name,
                travel=(-500.0, 500.0),
                rapid=400.0,
                max_feed=300.0,
                acceleration=2000.0,
                drive=drive,
            )
            for name in "XYZ"
        ),
        rapid=400.0,
        max_feed=300.0,
        max_cutting_force=None,
        max_axial_depth=None,
        block_time=None,
        base_power=300.0,
        coolant_power=200.0,
        tool_change=3.0,
        source="",
    )


@pytest.fixture(scope="session")
def lathe(mill: Machine) -> Machine:
    return replace(
        mill,
        kind=MachineKind.LATHE,
        axes=tuple(axis for axis in mill.axes if axis.name != "Y"),
        spindle=replace(mill.spindle, max_speed=60.0, acceleration=20.0),
    )


class EvenStock:
    """Slots of 10 mm by 2 mm wherever a feed goes; running state: how it was called."""

    def __init__(self) -> None:
        self.senses: list[bool] = []
        self.collisions: list[Collision] = []
        self.holder_collisions: list[Collision] = []
        self.shank_collisions: list[Collision] = []

    def cut(
        self, segments: Segments, shape: Cutter | Insert, *, is_clockwise: bool
    ) -> Stations:
        self.senses.append(is_clockwise)
        cuts = ~segments.is_rapid & (segments.length > 0.0)
        return Stations(
            segment=np.arange(len(segments)),
            station=segments.length,
            kind=np.where(cuts, int(StationKind.MILLING), int(StationKind.AIR)),
            section=np.where(cuts, 20.0, 0.0),
            growth=np.zeros(len(cuts)),
            axial_depth=np.where(cuts, 2.0, 0.0),
            radial_width=np.where(cuts, 10.0, 0.0),
            entry_angle=np.zeros(len(cuts)),
            exit_angle=np.where(cuts, pi, 0.0),
            contact_angle=np.where(cuts, pi, 0.0),
            chip_ratio=np.where(cuts, 2.0 / pi, 0.0),
            diameter=np.where(cuts, 10.0, 0.0),
        )


@pytest.fixture
def even_stock() -> Callable[[], EvenStock]:
    return EvenStock


@pytest.fixture(scope="session")
def samples_of() -> Callable[..., Samples]:
    """Samples at 100 Hz, 0 everywhere but in some columns."""

    def made(count: int, **columns: NDArray[np.generic]) -> Samples:
        values: dict[str, NDArray[np.generic]] = {}
        for each in fields(Samples):
            shape = (count, 3) if each.name in THREES else (count,)
            values[each.name] = np.zeros(shape, dtype=WHOLE.get(each.name, np.float64))
        values["time"] = np.arange(count) / 100.0
        return Samples(**(values | columns))  # type: ignore[arg-type]

    return made
