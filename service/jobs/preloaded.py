"""What all processes of jobs have in common: loaded once, where they are forked from."""

from importlib import import_module

for name in (
    "service.jobs.advise",
    "service.jobs.child",
    "service.jobs.evaluate",
    "service.jobs.simulate",
    "service.jobs.steer",
    "service.paths.toolpaths",
    "service.report",
    "service.simulation.report",
):
    import_module(name)
