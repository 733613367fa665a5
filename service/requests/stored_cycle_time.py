"""Request of the cycle time of a stored program, beside a log that the service has."""

from dataclasses import dataclass
from typing import Annotated

from service.requests.advice import MachineName
from service.requests.fields import About
from service.requests.program_facts import ProgramRequest
from service.requests.runs import MonitorName, OptionalId
from simulator.motion.model_name import ControlModelName


@dataclass(frozen=True, slots=True, kw_only=True)
class StoredCycleTimeRequest(ProgramRequest):
    """Cycle time of a program; with a log, the logged one too."""

    program_id: Annotated[
        OptionalId, About("an uploaded program (default: the one of the run)")
    ] = None
    advice_id: Annotated[OptionalId, About("or the program optimised by this advice")] = None
    log_id: Annotated[OptionalId, About("an uploaded log: .parquet, .csv or .xml")] = None
    run_id: Annotated[
        OptionalId, About("or the samples of this simulation or run under control")
    ] = None
    monitor: Annotated[
        MonitorName,
        About("or the latest run that the agent of this monitored machine still keeps"),
    ] = ""
    machine: MachineName = ""
    control: Annotated[
        ControlModelName, About("motion control of the path: exact-stop, junction or fir")
    ] = ControlModelName.FIR


@dataclass(frozen=True, slots=True, kw_only=True)
class QueuedCycleTime(StoredCycleTimeRequest):
    """Cycle time as a job has it: with what clients cannot choose."""

    agent_url: str = ""
    """Address of the monitored machine's agent, from the settings of the service."""
