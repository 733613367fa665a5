"""Request of ``dataset``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from service.requests.fields import About, FileUse, Request
from service.requests.files import Cluster


@dataclass(frozen=True, slots=True, kw_only=True)
class DatasetRequest(Request):
    """Request of a data set."""

    rows: Annotated[
        int | None,
        About(
            "number of rows (default: all combinations of a full factorial)", flag="--rows",
            short="-n", metavar="ROWS",
        ),
    ] = None  # fmt: skip
    has_csv: Annotated[bool, About("write FOLDER/data.csv as well", flag="--csv")] = False
    has_programs: Annotated[
        bool,
        About(
            "write the STEP-NC program of each row as FOLDER/programs/row-NNNNNN.stpnc",
            flag="--programs",
        ),
    ] = False


@dataclass(frozen=True, slots=True, kw_only=True)
class DatasetPlaces(Request):
    """Files of ``dataset``."""

    design: Annotated[Path, About("design file, .toml", use=FileUse.INPUT, metavar="DESIGN")]
    output: Annotated[
        Path,
        About(
            "folder of the data set; rows that are there are kept", flag="--output",
            short="-o", use=FileUse.OUTPUT, metavar="FOLDER",
        ),
    ]  # fmt: skip
    cluster: Cluster = ""


REQUEST, FILES = DatasetRequest, DatasetPlaces
