"""Modules loaded once in the fork server, so that job processes start quickly."""

from importlib import import_module

for name in (
    "service.jobs.advise",
    "service.jobs.child",
    "service.jobs.cycle_time",
    "service.jobs.evaluate",
    "service.jobs.produce",
    "service.jobs.review",
    "service.jobs.simulate",
    "service.jobs.steer",
    "service.jobs.verify",
    "service.paths.toolpaths",
    "service.verbs.optimise.plan_result",
    "service.verbs.simulate.result",
):
    import_module(name)
