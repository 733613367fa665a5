"""The job ``advice``: optimise a program, and keep all that may be asked about it."""

import json

from service.depot.library import machine_word, material_word
from service.jobs.task import NC_CODE, OPTIMISED, REPORT, Task
from service.usecases import Request, optimise
from service.wire import plan_json


def run(task: Task) -> None:
    """Advise feeds.

    Raises
    ------
    StepNcError
        As :func:`service.usecases.optimise`.
    """
    asked = task.request
    file, name = task.program_file()
    output = task.folder / OPTIMISED
    outcome = optimise(
        Request(
            file=file,
            name=name,
            mode=asked["mode"],
            machine=machine_word(task.depot, asked["machine"]),
            material=material_word(task.depot, asked["material"]),
            units=asked["units"],
            roughness_um=asked["roughness_um"],
            free=",".join(asked["free"]),
            profile=asked["profile"],
            output=output,
            workingsteps=tuple(asked["workingsteps"]),
            pareto=asked["has_pareto"],
            tool_change=asked["tool_change_s"],
            report=task.folder / REPORT,
            control=asked["nc_control"],
            knowledge=task.depot.knowledge if asked["has_corrections"] else "",
            safety=asked["safety"],
            # Jobs from before these could be asked for have none of them.
            confirm=asked.get("is_confirmed", False),
            stock=asked.get("stock", ""),
            centre_cutting=asked.get("centre_cutting", {}),
            allow_plunge=asked.get("allow_plunge", False),
        ),
        tell=task.tell,
    )
    if asked["nc_control"]:
        _name_code(task)
    task.keep({
        **json.loads(plan_json(outcome.plan, outcome.confirmation)),
        "program": name,
        "is_written": outcome.written is not None,
        "nc_control": asked["nc_control"] or None,
    })


def _name_code(task: Task) -> None:
    """NC code gets the name under which it is looked for."""
    stem = OPTIMISED.removesuffix(".stpnc")
    for file in task.folder.glob(f"{stem}.*"):
        if file.name != OPTIMISED:
            file.replace(task.folder / NC_CODE)
