"""Modules of all job processes: loaded once, in the process that they are forked from."""

from importlib import import_module

for name in (
    "service.jobs.advise",
    "service.jobs.child",
    "service.jobs.evaluate",
    "service.jobs.simulate",
    "service.jobs.steer",
    "service.paths.toolpaths",
    "service.plan_output",
    "service.simulation.output",
):
    import_module(name)
