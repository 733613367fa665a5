"""Three runs that correct the catalogue's cutting force for the next plan.

The catalogue's k_c is wrong by a factor that nobody told; plan, run, record, review, accept,
plan again. ``python examples/03_learning_from_runs.py [FACTOR]``: 1.35 when none is given; at
0.85 force is wasted instead.
"""

import sys
from math import exp
from pathlib import Path
from tempfile import TemporaryDirectory

from controller.laws.choice import LawName
from service.control.record import control_recorded
from service.knowledge.review import review
from service.knowledge.verbs import accept
from service.requests.advice import AdviceRequest
from service.requests.knowledge import ReviewRequest
from service.requests.runs import ControlRequest
from service.simulation.run import RunFiles
from service.verbs.optimise.program import advise_program as optimise
from service.verbs.optimise.request import AdviceFiles

PART = Path(__file__).parent / "parts" / "paper002.stpnc"
TRUTH = float(sys.argv[1]) if len(sys.argv) > 1 else 1.35
SHOP = {"machine": "vmc15", "material": "c45"}

print(f"the machine's k_c is {TRUTH:g} times the catalogue's")
print("run  k_c planned  feed mm/min  time s  force N  bound N  force/bound  learned factor")
with TemporaryDirectory() as folder:
    place = str(Path(folder) / "knowledge.db")
    for number in range(1, 4):
        planned = Path(folder) / f"plan{number}.stpnc"
        known = place if number > 1 else ""
        # Seven runs in ten need no more force than a plan at the 70 % quantile expects.
        plan = optimise(
            AdviceRequest(safety=0.7, **SHOP),
            AdviceFiles(file=PART, output=planned, kb=known),
        ).plan
        run = control_recorded(
            ControlRequest(
                law=LawName.NONE, disturbances=(f"kc:{TRUTH}",), seed=number, **SHOP
            ),
            RunFiles(file=planned),
            knowledge=place,
        )
        (found,) = review(place, ReviewRequest())
        accept(place, [found.entry.id], by="the planner")
        (advice,) = plan.advices
        record = next(record for advised, record in run.steps if advised)
        print(
            f"{number:3}  {advice.force_factor * advice.safety_factor:11.3f}  "
            f"{60.0 * advice.after.feed:11.1f}  "
            f"{record.time:6.1f}  {record.peak:7.0f}  {record.set_point:7.0f}  "
            f"{record.peak / record.set_point:11.3f}  {exp(found.learned.mean.centre):14.3f}"
        )
