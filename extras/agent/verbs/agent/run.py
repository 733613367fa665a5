"""An agent that serves clients until it is stopped."""

from dataclasses import replace

from extras.agent.requests import AgentRequest
from extras.agent.run import AgentFiles, serve_agent
from extras.agent.verbs.agent.request import AgentPlaces
from service.files import LOGS
from service.progress import Tell, silent
from service.simulation.run_files import placed_run
from service.verbs.result import ServedResult
from stepnc_model.errors import StepNcError


def run(request: AgentRequest, files: AgentPlaces, *, tell: Tell = silent) -> ServedResult:
    """Serve a run of a program, or what adapters tell, until told to stop.

    Raises
    ------
    StepNcError
        As :func:`extras.agent.run.serve_agent`.
    """
    if request.program_id or request.advice_id or request.pace:
        raise StepNcError("program_id, advice_id and pace are of the service: name a file")
    file = files.file
    is_log = file is not None and file.suffix.lower() in LOGS
    # A recorded run is neither a program nor NC code.
    named = replace(files, file=None) if is_log else files
    placed = placed_run(named, request)
    places = AgentFiles(
        run=replace(placed.files, file=file) if is_log else placed.files,
        device=files.device,
        schemas=files.schema_files,
        runs=files.runs,
    )
    serve_agent(placed.request, places, tell=tell)
    return ServedResult()
