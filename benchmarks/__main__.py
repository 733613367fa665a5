"""All benchmarks in one run: ``python -m benchmarks``."""

from benchmarks import (
    closed_loop,
    control_step,
    knowledge,
    part21,
    pockets,
    post,
    process,
    removal,
    rest,
    simulation,
    umich,
    workingsteps,
)

for title, bench in (
    ("Part 21", part21),
    ("Workingsteps", workingsteps),
    ("Whole process", process),
    ("Pockets", pockets),
    ("NC code", post),
    ("Removal", removal),
    ("Virtual machine", simulation),
    ("A real mill", umich),
    ("Closed loop", closed_loop),
    ("A control step", control_step),
    ("The knowledge base", knowledge),
    ("REST", rest),
):
    print(f"\n== {title}: {(bench.__doc__ or '').splitlines()[0]}")
    bench.main([])
