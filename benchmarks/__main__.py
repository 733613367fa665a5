"""All benchmarks in one run: ``python -m benchmarks``."""

from benchmarks import (
    advice,
    agent,
    breakage,
    closed_loop,
    control_step,
    knowledge,
    monitored,
    part21,
    pockets,
    post,
    process,
    promised,
    removal,
    rest,
    safety,
    simulation,
    spiral,
    umich,
    verification,
    workingsteps,
)

for title, bench in (
    ("Part 21", part21),
    ("Workingsteps", workingsteps),
    ("Whole process", process),
    ("Plan beside run", promised),
    ("Pockets", pockets),
    ("NC code", post),
    ("Removal", removal),
    ("Virtual machine", simulation),
    ("A real mill", umich),
    ("A spiral", spiral),
    ("Advice", advice),
    ("Safety", safety),
    ("Closed loop", closed_loop),
    ("Broken teeth", breakage),
    ("A control step", control_step),
    ("The knowledge base", knowledge),
    ("Verification of positions", verification),
    ("REST", rest),
    ("MTConnect", agent),
    ("A client's energy and time", monitored),
):
    print(f"\n== {title}: {(bench.__doc__ or '').splitlines()[0]}")
    bench.main([])
