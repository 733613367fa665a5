"""Run of a program of any kind on the virtual machine."""

from dataclasses import replace
from pkgutil import resolve_name

from service.progress import Tell, silent
from service.requests.runs import SimulationRequest
from service.simulation.facts import WORLD, stated
from service.simulation.run import simulate
from service.simulation.run_files import placed_run
from service.verbs.simulate.request import SimulateFiles
from service.verbs.simulate.result import SimulateResult
from simulator.client.document_choices import DocumentChoice

DOCUMENT = "extras.agent.run:simulated_with_document"
"""Function of an extra that runs a program and writes its document of MTConnect."""


def run(
    request: SimulationRequest, files: SimulateFiles, *, tell: Tell = silent
) -> SimulateResult:
    """Simulate a program.

    Raises
    ------
    StepNcError
        When a file, a name, a number or an output is not valid.
    """
    carbon = WORLD if files.carbon_g_kwh is None else stated(files.carbon_g_kwh)
    placed = placed_run(files, request)
    places, request = replace(placed.files, kept=files.keep_stock), placed.request
    if files.live is not None:
        from service.simulation.live import watched  # noqa: PLC0415 (numpy)

        with watched(files.live, request.pace) as live:
            found = simulate(request, places, tell=tell, watchers=(live,))
    elif files.mtconnect is None:
        found = simulate(request, places, tell=tell)
    else:
        choice = DocumentChoice(
            version=files.schema, names=files.names, part=files.part, batch=files.batch
        )
        found = resolve_name(DOCUMENT)(request, places, files.mtconnect, choice, tell=tell)
    return SimulateResult(simulation=found, carbon=carbon)
