"""Power of a lathe through the turning case of Shin et al. (2016).

Runs ``parts/paper000.stpnc`` on the paper's lathe and draws power against time with the five
events that the paper marks in its Fig. 8. ``python examples/01_paper000_power.py [PICTURE]``.
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

PART = Path(__file__).parent / "parts" / "paper000.stpnc"

with TemporaryDirectory() as folder:
    files = RunFiles(file=PART, output=Path(folder) / "run.parquet")
    stops = ControlModelName.EXACT_STOP
    simulate(SimulationRequest(machine="paper000", rate_hz=100.0, control=stops), files)
    table = parquet.read_table(files.output)
run = {name: table[name].to_numpy() for name in table.column_names}
time, total, spindle = run["time_s"], run["electric_wattage"], run["c_axis_wattage"]

# The samples at which the five events show.
entries = np.flatnonzero(np.diff((run["cutting_wattage"] > 0.0).astype(int)) > 0) + 1
events = {
    "1 spindle starts": spindle[: entries[0]].argmax(),
    "2 coolant": (run["coolant_wattage"] > 0.0).argmax(),
    "3 entry": entries[0],
    "4 smaller diameter, less power": entries[-1],
    "5 spindle stops": np.flatnonzero(spindle)[-1] + 1,
}

figure = Figure(figsize=(12.0, 5.5), layout="constrained")
whole, start = figure.subplots(1, 2, width_ratios=(2, 1), sharey=True)
for axes in (whole, start):
    # Before the program the machine draws its base load.
    axes.plot((-1.0, 0.0, *time), (*run["load_wattage"][[0, 0]], *total), label="total")
    axes.plot(time, spindle, label="spindle", linewidth=1.0)
    axes.set(xlabel="time, s", ylim=(-300.0, 1.1 * total.max()))
whole.set(ylabel="power, W", xlim=(-1.0, time[-1] + 6.0))
whole.legend()
start.set(title="the start", xlim=(-0.5, 4.0))
style = {"xytext": (12, 14), "textcoords": "offset points", "arrowprops": {"arrowstyle": "->"}}
for text, at in events.items():
    axes = start if time[at] < 3.0 else whole
    axes.annotate(text, (time[at], total[at]), **style)
picture = Path(sys.argv[1] if len(sys.argv) > 1 else "build/paper000_power.png")
picture.parent.mkdir(parents=True, exist_ok=True)
figure.savefig(picture, dpi=100)
print(f"picture: {picture}")
