"""Request of ``control``."""

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Annotated

from annotated_types import Interval

from service.requests.fields import About, FileUse
from service.requests.files import Knowledge
from service.requests.runs import ControlRequest
from service.simulation.run_files import RunOutputs


class LoadUnit(StrEnum):
    """Unit of a load that HAL has."""

    PERCENT = "%"
    AMPERE = "A"
    WATT = "W"
    NEWTON = "N"


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
    linuxcnc: Annotated[
        str,
        About(
            "run the NC code (--nc) on LinuxCNC: the socket of its component, or bench, which "
            "starts a LinuxCNC without a machine",
            flag="--linuxcnc", metavar="bench|SOCKET", group="LinuxCNC",
        ),
    ] = ""  # fmt: skip
    virtual_load: Annotated[
        bool,
        About(
            "take the load from the force model, with hidden disturbances, behind the motion "
            "of LinuxCNC; the bench always does",
            flag="--virtual-load", group="LinuxCNC",
        ),
    ] = False  # fmt: skip
    load_pin: Annotated[
        str,
        About("HAL pin of the load", flag="--load-pin", metavar="NAME", group="LinuxCNC"),
    ] = ""
    load_unit: Annotated[
        LoadUnit,
        About(
            "unit of the load pin: % or A of the rated load, W of the main drive, or N",
            flag="--load-unit", metavar="%|A|W|N", group="LinuxCNC",
        ),
    ] = LoadUnit.PERCENT  # fmt: skip
    rated: Annotated[
        float,
        Interval(ge=0.0, le=1e6),
        About(
            "load at the rated power of the main drive, in the unit of the pin; 100 for %",
            flag="--rated", metavar="VALUE", group="LinuxCNC",
        ),
    ] = 0.0  # fmt: skip
    load_limit: Annotated[
        float,
        Interval(ge=0.0, le=1e9),
        About(
            "force above which the realtime side of the bench holds the feed, N; 0: twice the "
            "greatest of the program",
            unit="N", flag="--load-limit", metavar="N", group="LinuxCNC",
        ),
    ] = 0.0  # fmt: skip
    kb: Knowledge = ""
    by: Annotated[
        str,
        About("author of the outcomes (default: login)", flag="--by", metavar="NAME"),
    ] = ""


REQUEST, FILES = ControlRequest, ControlFiles

USUAL = {"has_preview": False}
"""Values of the request that differ from those of REST, where nothing else is asked for."""
