"""An agent that serves clients until it is stopped."""

from dataclasses import replace

from service.agent.run import AgentFiles, serve_agent
from service.reading import Tell, silent
from service.requests.agent import AgentRequest
from service.simulation.code_files import run_files
from service.verbs.agent.request import AgentPlaces
from service.verbs.result import ServedResult
from stepnc_model.errors import StepNcError


def run(request: AgentRequest, files: AgentPlaces, *, tell: Tell = silent) -> ServedResult:
    """Serve a run of a program, or what adapters tell, until told to stop.

    Raises
    ------
    StepNcError
        As :func:`service.agent.run.serve_agent`.
    """
    if request.program_id or request.advice_id or request.pace:
        raise StepNcError("program_id, advice_id and pace are of the service: name a file")
    places = AgentFiles(
        run=run_files(files, files.file, stock=request.stock),
        device=files.device,
        schemas=files.schema_files,
        runs=files.runs,
    )
    if files.nc is not None:
        request = replace(request, stock="")
    serve_agent(request, places, tell=tell)
    return ServedResult()
