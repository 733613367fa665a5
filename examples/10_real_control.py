"""The closed loop on a real LinuxCNC: open and closed, and what the next plan learns of it.

The face of ``paper002`` at its optimised feed, on a workpiece that becomes 40 % harder on the
way. LinuxCNC runs without a machine, in real time: five minutes.
``python examples/10_real_control.py [FOLDER]``
"""

import sys
from pathlib import Path
from typing import Literal

import numpy as np
from matplotlib import pyplot
from pyarrow import csv

import stepnc

PART = Path(__file__).resolve().parent / "parts/paper002.stpnc"
SET_POINT = 250.0
LAWS: dict[str, Literal["none", "log-pi"]] = {"open loop": "none", "closed": "log-pi"}


def main(folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    plan, code, base = folder / "plan.stpnc", folder / "plan.ngc", str(folder / "runs.db")
    print(stepnc.optimise(PART, machine="vmc15", output=plan))
    stepnc.post(plan, control="linuxcnc", adaptive_feed=True, output=code)
    _, (above, below) = pyplot.subplots(2, 1, sharex=True, figsize=(8, 5))
    for name, law in LAWS.items():
        log = folder / f"{law}.csv"
        run = stepnc.control(
            plan, nc=code, linuxcnc="bench", machine="vmc15", law=law, output=log,
            force_set_point_n=SET_POINT, disturbances=("hardness:+40%@60s",),
            kb=base if law != "none" else "",
        )  # fmt: skip
        print(f"--- {name}", run, sep="\n")
        rows = csv.read_csv(log)
        time, force, override = (
            np.asarray(rows[each], dtype=float)
            for each in ("time_s", "force_true", "override_actual")
        )
        above.plot(time, force, label=name)
        below.plot(time, 100.0 * override, label=name)
    above.axhline(SET_POINT, color="0.6", linestyle="--")
    above.set(ylabel="force, N")
    above.legend()
    below.set(xlabel="time, s", ylabel="override, %", ylim=(0.0, 110.0))
    pyplot.savefig(folder / "real_control.png", dpi=100)
    print(stepnc.kbe_review(kb=base, auto_accept=True, fewest_outcomes=1, least_confidence=0.0))
    print("--- next plan", stepnc.optimise(PART, machine="vmc15", kb=base), sep="\n")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path("build/real_control"))
