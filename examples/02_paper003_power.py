"""Power above idle and time of a pass for the two slots of Lechevalier et al. (2018).

Runs ``parts/paper003_case1.stpnc`` and ``case2`` on the paper's mill and draws power against
time. ``python examples/02_paper003_power.py [PICTURE]``.
"""

import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from matplotlib.figure import Figure
from pyarrow import parquet

from service.requests.runs import SimulationRequest
from service.simulation.run import RunFiles, simulate
from simulator.motion.model_name import ControlModelName

PARTS = Path(__file__).parent / "parts"


def run(name: str) -> dict[str, np.ndarray]:
    with TemporaryDirectory() as folder:
        output = Path(folder) / "run.parquet"
        simulate(
            SimulationRequest(machine="paper003", control=ControlModelName.EXACT_STOP),
            RunFiles(file=PARTS / f"{name}.stpnc", output=output),
        )
        table = parquet.read_table(output)
    return {name: table[name].to_numpy() for name in table.column_names}


figure = Figure(figsize=(11.0, 7.0), layout="constrained")
for axes, name in zip(figure.subplots(2, sharex=True), ("case1", "case2"), strict=True):
    columns = run(f"paper003_{name}")
    time, cutting = columns["time_s"], columns["cutting_wattage"]
    x, full = columns["x_axis_position_actual"], columns["radial_width"] > 7.99
    seconds = 101.6 / columns["path_feedrate_actual"][full].mean()
    spindle = columns["c_axis_wattage"]
    watts = spindle[full].mean() - spindle[columns["path_mode"] == "FEED"][0]
    axes.plot(time, columns["electric_wattage"], label="total")
    axes.plot(time, cutting, label="at the edge", linewidth=1.0)
    axes.set(ylim=(0.0, 1000.0), ylabel="power, W")
    axes.set_title(f"{name}: {watts:.1f} W above idle, {seconds:.2f} s a pass of 101.6 mm")
    axes.legend(loc="lower right")
axes.set_xlabel("time, s")
picture = Path(sys.argv[1] if len(sys.argv) > 1 else "build/paper003_power.png")
picture.parent.mkdir(parents=True, exist_ok=True)
figure.savefig(picture, dpi=100)
print(f"picture: {picture}")
