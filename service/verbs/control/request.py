"""Request of ``control``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from service.requests.fields import About, FileUse
from service.requests.files import Knowledge
from service.requests.run_files import RunOutputs
from service.requests.runs import ControlRequest


@dataclass(frozen=True, slots=True, kw_only=True)
class ControlFiles(RunOutputs):
    """Files of ``control``."""

    band: Annotated[
        str,
        About(
            "override band, %; the guard may go lower to protect the tool (default: 20,120)",
            flag="--band", metavar="LOW,HIGH",
        ),
    ] = ""  # fmt: skip
    recorded: Annotated[
        str | None,
        About(
            "evaluate a recorded run of the program instead: a .parquet or .csv file of "
            "`record`, or the next run that an MTConnect agent publishes",
            flag="--recorded", metavar="FILE|URL",
        ),
    ] = None  # fmt: skip
    loads: Annotated[
        Path | None,
        About(
            "reference loads by tool and cut (JSON): a cut that has none teaches its own, "
            "later runs are compared with it",
            flag="--loads", use=FileUse.OUTPUT, metavar="FILE",
        ),
    ] = None  # fmt: skip
    teach: Annotated[bool, About("teach the loads of all cuts anew", flag="--teach")] = False
    cut_log: Annotated[
        Path | None,
        About(
            "write a row for each cut: times, powers, reference load, least feed, wear, and "
            "what was done",
            flag="--cut-log", use=FileUse.OUTPUT, metavar="CSV",
        ),
    ] = None  # fmt: skip
    kb: Knowledge = ""
    by: Annotated[
        str,
        About("author of the outcomes (default: login)", flag="--by", metavar="NAME"),
    ] = ""


REQUEST, FILES = ControlRequest, ControlFiles

USUAL = {"has_preview": False}
"""Values of the request that differ from those of REST, where nothing else is asked for."""
