"""Request of ``optimise``: the values are those of REST, the files are named by people.

Place of the advised program: another file than the input, unless it is asked for.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from service.files import is_same, require_place, require_places, sibling
from service.requests.advice import AdviceRequest
from service.requests.fields import About, FileUse, Request
from service.requests.files import Knowledge, MostRepeats, Report, SetupOfCode, ToolsUnit
from stepnc_model.errors import StepNcError, WriteError


@dataclass(frozen=True, slots=True, kw_only=True)
class AdviceFiles(Request):
    """Files that ``optimise`` reads and writes."""

    file: Annotated[
        Path,
        About(
            "a STEP-NC program (Part 21), a folder of them, or NC code", use=FileUse.PROGRAM,
            metavar="FILE",
        ),
    ]  # fmt: skip
    name: str = ""
    """Name of the program; empty: the name of its file."""
    output: Annotated[
        Path | None,
        About(
            "default: FILE.optimised.stpnc, or the suffix of NC code; of a folder: another "
            "folder",
            group="what is written",
            flag="--output", short="-o", use=FileUse.OUTPUT, metavar="FILE",
        ),
    ] = None  # fmt: skip
    in_place: Annotated[
        bool, About("overwrite the input file", group="what is written", flag="--in-place")
    ] = False
    holding: Annotated[
        Path | None,
        About(
            "work-holding: [[holding]] tables of chuck, vice or clamps, by setup",
            flag="--holding", use=FileUse.INPUT, metavar="TOML",
        ),
    ] = None  # fmt: skip
    tools: Annotated[
        Path | None,
        About(
            "tool table: the tools of NC code; of a program, those that it only names, and "
            "which cut over centre or have wipers",
            group="NC code", flag="--tools", use=FileUse.INPUT, metavar="TABLE",
        ),
    ] = None  # fmt: skip
    tools_unit: ToolsUnit = None
    setup: SetupOfCode = None
    most_repeats: MostRepeats = None
    kb: Knowledge = ""
    feeds_csv: Annotated[
        Path | None,
        About(
            "write the feeds along the paths as a table", group="along the path",
            flag="--feeds-csv", use=FileUse.OUTPUT, metavar="CSV",
        ),
    ] = None  # fmt: skip
    dry_run: Annotated[
        bool, About("write no optimised program", group="what is written", flag="--dry-run")
    ] = False
    report: Report = None
    cluster: Annotated[
        str,
        About(
            "optimise the programs of a folder on the Dask cluster of this scheduler, "
            "tcp://127.0.0.1:8786 or, beyond this machine, tls://HOST:PORT (default: on "
            "processes of this machine)",
            flag="--cluster", metavar="ADDRESS",
        ),
    ] = ""  # fmt: skip


REQUEST, FILES = AdviceRequest, AdviceFiles


def output_of(files: AdviceFiles, suffix: str) -> Path:
    """Return the path of the advised program.

    Parameters
    ----------
    files : AdviceFiles
    suffix : str
        End of its name where none is given.

    Raises
    ------
    StepNcError
        When an output would take the place of another file.
    """
    if files.in_place:
        if files.output is not None:
            raise StepNcError("--in-place and --output exclude each other")
        output = files.file
    else:
        output = files.output or sibling(files.file, suffix)
        if is_same(files.file, output):
            message = "is the input file; use --in-place to overwrite it"
            raise WriteError(message, path=str(output))
        if not files.dry_run:
            require_place(output, apart_from=files.file)
    require_places([files.report, files.feeds_csv], apart_from=[files.file, output])
    return output
