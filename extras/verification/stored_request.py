"""Request to verify a log that the service has, or gets from a monitored machine."""

from dataclasses import dataclass
from typing import Annotated

from extras.verification.requests import VerificationRequest
from service.requests.fields import About
from service.requests.program_facts import Name
from service.requests.runs import MonitorName, OptionalId, StockId, StockSolid


@dataclass(frozen=True, slots=True, kw_only=True)
class StoredVerificationRequest(VerificationRequest):
    """Verification of one log: an uploaded one, that of a run, or that of a machine."""

    program_id: Annotated[
        OptionalId,
        About(
            "an uploaded program (default: the one of the run; without any, machine, stock "
            "or stock_id, tools_id and required_id are needed)"
        ),
    ] = None
    advice_id: Annotated[OptionalId, About("or the program optimised by this advice")] = None
    log_id: Annotated[OptionalId, About("an uploaded log")] = None
    run_id: Annotated[
        OptionalId, About("or the samples of this simulation or run under control")
    ] = None
    monitor: Annotated[
        MonitorName,
        About("or the latest run that the agent of this monitored machine still keeps"),
    ] = ""
    tools_id: Annotated[OptionalId, About("an uploaded tool table with measured tools")] = None
    stock_id: StockId = None
    stock_solid: StockSolid = ""
    required_id: Annotated[
        OptionalId, About("an uploaded required part, in place of the features")
    ] = None
    required_solid: Annotated[
        Name,
        About(
            "the solid of a required part with several, by its name or its place in the file"
        ),
    ] = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class QueuedVerification(StoredVerificationRequest):
    """Verification as a job has it: with what clients cannot choose."""

    agent_url: str = ""
    """Address of the monitored machine's agent, from the settings of the service."""
