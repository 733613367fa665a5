"""Request for advice on a program that the service has, with an uploaded tool table."""

from dataclasses import dataclass
from typing import Annotated

from service.requests.advice import AdviceRequest
from service.requests.fields import About
from service.requests.runs import OptionalId, StockId, StockSolid
from simulator.tool_files.file_unit import FileUnit


@dataclass(frozen=True, slots=True, kw_only=True)
class StoredAdviceRequest(AdviceRequest):
    """Advice on an uploaded program."""

    tools_id: Annotated[
        OptionalId,
        About(
            "an uploaded tool table: the tools of NC code; of a STEP-NC program, which cut "
            "over centre or have wipers"
        ),
    ] = None
    stock_id: StockId = None
    stock_solid: StockSolid = ""
    tools_unit: Annotated[
        FileUnit | None,
        About("unit of lengths of a tool table that states none, LinuxCNC's (default: mm)"),
    ] = None
