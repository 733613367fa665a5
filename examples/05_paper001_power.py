"""Power of cuts within Table 1 of Lechevalier et al. (2015) on the mill of their later paper.

The paper prints ranges of feed, spindle speed and depth, but neither tool, material nor
machine: here they cut the slot of ``parts/paper003_case1.stpnc`` in one layer.
``python examples/05_paper001_power.py``.
"""

from math import pi
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from pyarrow import parquet

from service.requests.runs import SimulationRequest
from service.simulation.run import RunFiles, simulate
from simulator.motion.model_name import ControlModelName

SLOT = (Path(__file__).parent / "parts" / "paper003_case1.stpnc").read_text(encoding="utf-8")
MIDDLE = 50.8
"""mm along the slot"""
CUTS = ((30, 75.4, 2.5), (30, 226.2, 2.5), (60, 150.8, 3.0), (90, 75.4, 3.5), (90, 226.2, 3.5))
"""mm/s, rad/s, mm"""


def run(feed: float, speed: float, depth: float, folder: Path) -> dict[str, np.ndarray]:
    """Samples of the slot at another feed, spindle speed and depth."""
    text = SLOT.replace("(0.00207433333333333,", f"({feed / 1000.0},")
    text = text.replace("-29.1666666666667", f"{-speed / (2.0 * pi)}")
    text = text.replace("(0.,0.,-6.)", f"(0.,0.,{-depth})").replace(
        "     1.5,8.", f" {depth},8."
    )
    part, output = folder / "slot.stpnc", folder / "run.parquet"
    part.write_text(text, encoding="utf-8")
    simulate(
        SimulationRequest(
            machine="paper003", control=ControlModelName.EXACT_STOP, rate_hz=1000.0
        ),
        RunFiles(file=part, output=output),
    )
    table = parquet.read_table(output)
    return {name: table[name].to_numpy() for name in table.column_names}


print("mm/s  rad/s   mm  f_z mm  k_c N/mm2  F_c N   P_c W  spindle W  axis W  total W  ramp W")
for cut in CUTS:
    with TemporaryDirectory() as folder:
        columns = run(*cut, Path(folder))
    x, full = columns["x_axis_position_actual"], columns["radial_width"] > 7.99
    row = np.flatnonzero(full & (x < MIDDLE))[-1]
    in_air = columns["c_axis_wattage"][columns["cutting_wattage"] == 0.0]
    at = {name: values[row] for name, values in columns.items() if values.dtype.kind == "f"}
    print(
        f"{cut[0]:4} {cut[1]:6} {cut[2]:4} {2.0 * pi * cut[0] / cut[1] / 4.0:7.3f}"
        f"{1000.0 * at['cutting_wattage'] / at['removal_rate']:11.0f}{at['cutting_force']:7.0f}"
        f"{at['cutting_wattage']:8.1f}{at['c_axis_wattage']:11.1f}{at['x_axis_wattage']:8.2f}"
        f"{at['electric_wattage']:9.1f}{in_air.max():8.0f}"
    )
