"""Request of ``simulate``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from annotated_types import Interval

from service.live.journal import LiveFolder
from service.requests.fields import About, FileUse
from service.requests.runs import SimulationRequest
from service.simulation.run_files import RunOutputs
from simulator.client.document_choices import NameSet, SchemaVersion


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulateFiles(RunOutputs):
    """Files of ``simulate``."""

    live: LiveFolder | None = None
    """Folder of live samples for people who watch; None: nobody does."""

    carbon_g_kwh: Annotated[
        float | None,
        Interval(gt=0.0, le=10_000.0),
        About(
            "grams of CO2 per kWh (default 480)", unit="g/kWh", name="carbon factor",
            flag="--carbon-g-kwh", metavar="G",
        ),
    ] = None  # fmt: skip
    keep_stock: Annotated[
        Path | None,
        About(
            "write the remaining stock, which --stock of a later run can take",
            flag="--keep-stock", use=FileUse.OUTPUT, metavar="NPZ",
        ),
    ] = None  # fmt: skip
    mtconnect: Annotated[
        Path | None,
        About(
            "write the run as an MTConnect document; in a folder its name is MACHINE_PART.xml",
            flag="--mtconnect", use=FileUse.OUTPUT, metavar="XML", group="MTConnect document",
        ),
    ] = None  # fmt: skip
    schema: Annotated[
        SchemaVersion,
        About(
            "schema version of it: 1.3, 2.0 or 2.7", name="schema version", flag="--schema",
            group="MTConnect document",
        ),
    ] = SchemaVersion.V2_7  # fmt: skip
    names: Annotated[
        NameSet,
        About(
            "ids in it: modern, or papers", name="set of names", flag="--names",
            group="MTConnect document",
        ),
    ] = NameSet.MODERN  # fmt: skip
    part: Annotated[
        str,
        About(
            "id of the part in it", flag="--part", metavar="ID", group="MTConnect document"
        ),
    ] = ""  # fmt: skip
    batch: Annotated[
        str,
        About(
            "id of the batch in it", flag="--batch", metavar="ID", group="MTConnect document"
        ),
    ] = ""  # fmt: skip


REQUEST, FILES = SimulationRequest, SimulateFiles

USUAL = {"rate_hz": 10.0}
"""Values of the request that differ from those of REST, where nothing else is asked for."""
