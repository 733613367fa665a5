"""NC programs that somebody else wrote, and what optimising them needs."""

from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from service.programs.machine_choice import load_material_named
from service.requests.advice import AdviceRequest
from service.requests.program_facts import RawPart
from service.simulation.code_paths import CodePaths
from service.verbs.optimise.code import optimise_code
from service.verbs.optimise.code_result import CodeAdvice
from service.verbs.optimise.request import AdviceFiles
from simulator.library import load_machine
from simulator.tool_files.read import read_tools
from stepnc_model.nc.program import read_program
from stepnc_model.post.dialect import Dialect

TOOLS = """number,kind,diameter_mm,corner_radius_mm,teeth
1,endmill,12,0,4
2,endmill,8,0,3
5,drill,8,0,2
6,endmill,6,3,2
"""
INSERTS = """number,kind,nose_radius_mm,width_mm,cutting_edge_angle_deg
1,turning,0.8,,93
3,grooving,0.2,3,90
4,threading,0.2,,60
"""
BOX = "0,0,-20,100,80,0"
BAR = "50,-60,0.5"

MILL = AdviceRequest(machine="vmc15", material="c45", stock=BOX)
LATHE = replace(MILL, machine="lathe22", stock=BAR)

HEAD = "%\nO0001\nG21 G90 G17 G54\nT1 M6\nS3000 M3\n"
PASS = "G0 X-10. Y{y}\nZ-4.\nG1 X110. F300.\nG0 Z20.\n"
END = "M30\n%\n"


def slot(y: float) -> str:
    """Pass along x through the block, 4 mm deep, at 300 mm/min."""
    return PASS.format(y=f"{y:.1f}")


@cache
def advised(text: str, request: AdviceRequest = MILL, *, tools: str = "") -> CodeAdvice:
    """Feeds along the paths of a program, and the program with them."""
    with TemporaryDirectory() as folder:
        file, table = Path(folder) / "part.nc", Path(folder) / "tools.csv"
        file.write_bytes(text.encode("latin-1"))
        table.write_text(tools or (INSERTS if request.machine == "lathe22" else TOOLS))
        return optimise_code(request, AdviceFiles(file=file, tools=table, dry_run=True))


def rewritten(text: str, request: AdviceRequest = MILL) -> str:
    """Program with the advised feeds."""
    return advised(text, request).rewritten.data.decode("latin-1")


def paths_of(text: str, *, stock: RawPart = BOX, dialect: Dialect | None = None) -> CodePaths:
    """Moves of a program that can be run."""
    with TemporaryDirectory() as folder:
        table = Path(folder) / "tools.csv"
        table.write_text(INSERTS if stock == BAR else TOOLS)
        tools = read_tools(table, unit=None).by_number
    return CodePaths(
        read_program(text.encode("latin-1"), dialect=dialect),
        load_machine("lathe22" if stock == BAR else "vmc15"),
        load_material_named("c45"),
        name="part",
        tools=tools,
        stock=stock,
    )


def lines_of(text: str, *words: str) -> list[int]:
    """Lines that hold some words, counted from 1."""
    return [
        line
        for line, written in enumerate(text.splitlines(), start=1)
        if any(word in written for word in words)
    ]
