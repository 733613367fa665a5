"""Files and options that several verbs have besides their requests."""

from pathlib import Path
from typing import Annotated

from annotated_types import Interval, MaxLen

from service.requests.fields import About, FileUse
from service.requests.program_facts import Name
from simulator.tool_files.file_unit import FileUnit
from stepnc_model.post.dialect import Dialect

ProgramFile = Annotated[
    Path,
    About("a STEP-NC program (Part 21), or NC code", use=FileUse.INPUT, metavar="FILE"),
]

CodeControl = Annotated[
    Dialect | None,
    About(
        "control of NC code: linuxcnc, fanuc, haas, sinumerik or heidenhain (default: guessed "
        "from the code)",
        name="control", flag="--control", metavar="NAME",
    ),
]  # fmt: skip

KeepsGoing = Annotated[
    bool,
    About(
        "skip workingsteps for which no path can be generated; exit code 3 remains",
        flag="--keep-going",
    ),
]

MostRepeats = Annotated[
    int | None,
    Interval(ge=0, le=999_999_999),
    About(
        "blocks, and moves, that NC code may execute beyond those of its file, by calls, loops "
        "and repeated cycles (default: 1000000, which take about 100 MB and 10 s)",
        group="NC code", flag="--most-repeats", metavar="N",
    ),
]  # fmt: skip

KeepsState = Annotated[
    tuple[Name, ...],
    MaxLen(1000),
    About(
        "of NC code: a program that it calls by M98 or G65, that is not in its file, and "
        "that leaves modal state and offsets as they were; repeatable",
        group="NC code", flag="--keeps-state", metavar="PNUMBER",
    ),
]  # fmt: skip

Report = Annotated[
    Path | None,
    About(
        "write a self-contained page with plots",
        flag="--report", use=FileUse.OUTPUT, metavar="HTML",
    ),
]  # fmt: skip

NamedTools = Annotated[
    Path | None,
    About(
        "tool table of the tools that a program only names: TOML or CSV, LinuxCNC's tool.tbl, "
        "a library of Fusion (.json, .tools), HSMWorks (.hsmlib) or FreeCAD (.fctl)",
        flag="--tools", use=FileUse.INPUT, metavar="TABLE",
    ),
]  # fmt: skip

ToolsUnit = Annotated[
    FileUnit | None,
    About(
        "unit of a tool.tbl: mm or inch",
        name="unit",
        group="NC code",
        flag="--tools-unit",
        metavar="UNIT",
    ),
]

Knowledge = Annotated[
    str,
    About(
        "knowledge base, a file or postgresql://…, with accepted corrections of k_c; runs "
        "record their outcomes in it (default: $STEPNC_KB)",
        flag="--kb", metavar="PLACE",
    ),
]  # fmt: skip

Cluster = Annotated[
    str,
    About(
        "run on the Dask cluster of this scheduler, tcp://127.0.0.1:8786 or, beyond this "
        "machine, tls://HOST:PORT (default: on processes of this machine)",
        flag="--cluster", metavar="ADDRESS",
    ),
]  # fmt: skip

EntryName = Annotated[
    str | None,
    About(
        "show only this one, in full: its name or the path of its file",
        use=FileUse.INPUT, metavar="NAME",
    ),
]  # fmt: skip

SetupOfCode = Annotated[
    Path | None,
    About(
        "setup of NC code: tools, stock, material and machine, as `stepnc setup` drafts it "
        "(default: PART.setup.toml beside PART.nc)",
        group="NC code", flag="--setup", use=FileUse.INPUT, metavar="TOML",
    ),
]  # fmt: skip
