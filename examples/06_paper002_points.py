"""The points 1 to 10 of the simulator of Ridwan, Xu and Liu (2010), Fig. 9, by the real loop.

The case of the paper's Table 2 with one tooth: 18 mm, 35 m/min, 0.29 kW, efficiency 0.9. Steel
is ``paper002`` (1000 N/mm², Table 2) up to point 4 and St37 from 5 on. The inputs of the figure
cannot be read. ``python examples/06_paper002_points.py``.
"""

from statistics import fmean

from service.trial.inputs import Inputs, changed
from service.trial.run import TrialRun

TABLE_2 = Inputs(
    material="paper002",
    tool_diameter_mm=18.0,
    teeth=1,
    cutting_speed_m_min=35.0,
    feed_per_tooth_mm=0.5,
    axial_depth_mm=4.0,
    motor_power_kw=0.29,
)
FINISH = {"mode": "QC", "feed_per_tooth_mm": 0.1, "axial_depth_mm": 1.5}
"""Table 1, finishing"""
POINTS = (
    ("1", {}),
    ("2", {"axial_depth_mm": 3.0}),
    ("3", {"motor_power_kw": 0.2}),
    ("4", {"motor_power_kw": 0.29}),
    ("5", {"material": "st37"}),
    ("6", {"material": "al6061"}),
    ("7", FINISH),
    ("8", {"material": "st37"}),
    ("9", {"axial_depth_mm": 3.0}),
    ("10", {"motor_power_kw": 0.58}),
    ("10'", {"motor_power_kw": 0.1}),
)
SETTLED, MEAN = 12.0, 4.0
"""s"""

run = TrialRun(TABLE_2)
spindle = 1000.0 * TABLE_2.cutting_speed_m_min / (3.14159265 * TABLE_2.tool_diameter_mm)
print(
    "point mode material  depth mm  motor W |   F N  drive W  cm3/min  mm/rev  mm/min  held by"
)
for point, changes in POINTS:
    run.change(changed(run.inputs, **changes))
    run.advance(run.time + SETTLED)
    rows = [row for row in run.taken().moments if row.time > run.time - MEAN]
    at, feed = run.inputs, 60.0 * fmean(row.feed_actual for row in rows)
    print(
        f"{point:5} {at.mode:4} {at.material:8} {at.axial_depth_mm:9} "
        f"{1000.0 * at.motor_power_kw:8.0f} | {fmean(row.force_true for row in rows):5.0f} "
        f"{fmean(row.spindle_power_true for row in rows):8.0f} "
        f"{0.06 * fmean(row.removal_rate for row in rows):8.1f} {feed / spindle:7.3f} "
        f"{feed:7.0f}  {run.status().holding}"
    )
