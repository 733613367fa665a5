"""Lechevalier et al., "A virtual milling machine model ...", 2015: cuts within its Table 1.

Print gives feed 30 to 90 mm/s, spindle 75.4 to 226.2 rad/s and depth 2.5 to 3.5 mm, and the
equations (1) to (4), without tool, material or machine. Here the cutter (Ø8 mm, 4 teeth, full
slot) and the machine are those of the paper of 2018, whose equations are the same; AISI 1018
has ISCAR's 1350 N/mm² and 0.21. What the run shows is worked by hand from the corrected forms.
"""

from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from pyarrow import parquet

from service.simulation.run import simulate
from simulator.library import load_machine
from simulator.physics.axis import axis_power
from stepnc_model.units import rev_s_from_rpm
from tests.asking import asked_simulation

SLOT = Path(__file__).parents[2] / "examples" / "parts" / "paper003_case1.stpnc"
DIAMETER, TEETH = 8.0, 4
EFFICIENCY, AXIS_EFFICIENCY = 0.95, 0.93
LEAD = 15.0
"""mm/rev"""
FRICTION, VISCOUS = 0.45736, 0.005
"""N·m; N·m·s/rad: Fig. 5 of the paper of 2018, tests/reference/test_lechevalier_2018.py"""
BEARING = 0.01 * 30.0 / 2.0
"""mm: μ_b·d/2"""
RADIAL = 0.3
"""F_r over F_t, docs/models.md"""
BASE, COOLANT = 370.0, 280.0
INERTIA, ACCELERATION = 0.5, 10.0
"""kg·m²; rev/s²"""
CHANNELS = {
    "x_axis_wattage",
    "y_axis_wattage",
    "z_axis_wattage",
    "c_axis_wattage",
    "electric_wattage",
    "coolant_wattage",
}
"""§4.2; positions are called ``x_axis_position_actual`` here, and so on"""

CUTS = [
    (30.0, 75.4, 2.5),
    (30.0, 226.2, 2.5),
    (60.0, 150.8, 3.0),
    (90.0, 75.4, 3.5),
    (90.0, 226.2, 3.5),
]
"""mm/s, rad/s, mm: ends and middle of Table 1"""

Columns = dict[str, NDArray[Any]]


def run(cut: tuple[float, float, float], folder: Path, rate: float = 1000.0) -> Columns:
    """The slot in one layer."""
    feed, speed, depth = cut
    text = SLOT.read_text(encoding="utf-8")
    for old, new in (
        ("(0.00207433333333333,", f"({feed / 1000.0},"),
        ("-29.1666666666667", f"{-speed / (2.0 * pi)}"),
        ("(0.,0.,-6.)", f"(0.,0.,{-depth})"),
        ("     1.5,8.", f"     {depth},8."),
    ):
        assert text.count(old) == 1
        text = text.replace(old, new)
    part, output = folder / "slot.stpnc", folder / "run.parquet"
    part.write_text(text, encoding="utf-8")
    simulate(
        *asked_simulation(
            file=part, machine="paper003", control="exact-stop", rate=rate, output=output
        )
    )
    table = parquet.read_table(output)
    return {name: table[name].to_numpy() for name in table.column_names}


def axis_watts(feed: float, feed_force: float) -> float:
    """Eq. (3) with B·w in the steady state too, W."""
    angular = 2.0 * pi * feed / LEAD
    load = feed_force * (LEAD / (2.0 * pi) + BEARING) / 1000.0
    return (FRICTION + VISCOUS * angular + load) * angular / AXIS_EFFICIENCY


@pytest.mark.parametrize("cut", CUTS, ids=str)
def test_cut_within_table_1_has_the_power_of_the_corrected_equations(
    cut: tuple[float, float, float], tmp_path: Path
) -> None:
    feed, speed, depth = cut
    columns = run(cut, tmp_path)
    x = columns["x_axis_position_actual"]
    row = np.flatnonzero((columns["radial_width"] > 7.99) & (x < 50.8))[-1]
    at = {name: values[row] for name, values in columns.items()}
    chip = 2.0 * pi * feed / speed / TEETH
    specific = 1350.0 * (2.0 * chip / pi) ** -0.21
    cutting = specific * depth * DIAMETER * feed / 1000.0
    axis = axis_watts(feed, RADIAL * specific * depth * chip * TEETH / 4.0)
    assert at["cutting_wattage"] == pytest.approx(cutting, rel=1e-3)
    assert at["cutting_force"] == pytest.approx(
        1000.0 * cutting / (0.5 * speed * DIAMETER), rel=1e-3
    )
    # As printed, eq. (4), it would be 2π times as much.
    assert at["c_axis_wattage"] == pytest.approx(cutting / EFFICIENCY, rel=1e-3)
    assert at["x_axis_wattage"] == pytest.approx(axis, rel=2e-3)
    total = BASE + COOLANT + cutting / EFFICIENCY + axis
    assert at["electric_wattage"] == pytest.approx(total, rel=1e-3)
    ramp = INERTIA * 2.0 * pi * ACCELERATION * speed / EFFICIENCY
    in_air = columns["c_axis_wattage"][columns["cutting_wattage"] == 0.0]
    assert in_air.max() == pytest.approx(ramp, rel=2e-3)


@pytest.mark.parametrize(
    ("speed", "steady", "printed"), [(30.0, 7.033, 6.180), (60.0, 15.755, 12.360)]
)
def test_steady_power_of_an_axis_lacks_the_viscous_part_in_print(
    speed: float, steady: float, printed: float
) -> None:
    """Eq. (3): T_s alone at constant speed; while it speeds up B·w is added."""
    drive = load_machine("paper003").axes[0].drive
    assert drive is not None
    assert axis_power(drive, speed) == pytest.approx(steady, rel=1e-3)
    bare = FRICTION * 2.0 * pi * speed / LEAD / AXIS_EFFICIENCY
    assert bare == pytest.approx(printed, rel=1e-3)


def test_samples_of_100_ms_have_the_channels_of_print(tmp_path: Path) -> None:
    columns = run(CUTS[2], tmp_path, rate=10.0)
    assert columns.keys() >= CHANNELS | {f"{axis}_axis_position_actual" for axis in "xyz"}
    assert np.diff(columns["time_s"][:-1]) == pytest.approx(0.1)


@pytest.mark.parametrize(("angular", "rpm"), [(75.4, 720.0), (226.2, 2160.0)])
def test_speeds_of_table_1_are_whole_revolutions(angular: float, rpm: float) -> None:
    assert angular / (2.0 * pi) == pytest.approx(rev_s_from_rpm(rpm), rel=1e-4)


def test_table_1_asks_for_more_than_a_steel_cutter_bears() -> None:
    """Four teeth: 0.21 to 1.88 mm a tooth; ISCAR has at most 0.01 D = 0.08 mm in such steel."""
    least, most = (
        2.0 * pi * feed / speed / TEETH for feed, speed in ((30.0, 226.2), (90.0, 75.4))
    )
    assert (least, most) == pytest.approx((0.2083, 1.875), rel=1e-3)
    assert least > 0.01 * DIAMETER
