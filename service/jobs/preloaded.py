"""Modules loaded once in the fork server, so that job processes start quickly."""

from importlib import import_module
from pkgutil import resolve_name

from service.jobs.child import WORK
from service.jobs.verb_job import STORED
from service.verbs.call import verbs

for name in WORK.values():
    resolve_name(name)
for name in (
    "service.programs.toolpaths",
    "service.verbs.optimise.code",
    *(verbs()[stored.name].module("run") for stored in STORED.values()),
):
    import_module(name)
