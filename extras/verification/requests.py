"""Request of a verification."""

from dataclasses import dataclass
from typing import Annotated

from annotated_types import Interval

from service.requests.advice import MachineName, MaterialName
from service.requests.fields import About
from service.requests.program_facts import Name, ProgramRequest, StockText, raw_part_in

INCH_THOUSANDTH = 0.0254
"""0.001 inch in mm, which paper 004 resolves."""


@dataclass(frozen=True, slots=True, kw_only=True)
class VerificationRequest(ProgramRequest):
    """Request to compare the part that logged positions left with the programmed one."""

    machine: MachineName = ""
    material: MaterialName = ""
    stock: Annotated[
        StockText,
        About(
            "raw part where there is no program, or it defines none, in mm: "
            "x0,y0,z0,x1,y1,z1 or diameter,z0,z1; on the command line also an STL or STEP file",
            flag="--stock", metavar="STOCK", examples=("0,0,-30,100,120,5",), read=raw_part_in,
        ),
    ] = ""  # fmt: skip
    zero: Annotated[
        Name,
        About(
            "position of the program's zero on the axes in mm, x,y,z (default: as the log "
            "tells it, or else 0,0,0); fit: to the program, in whole millimetres",
            flag="--zero", metavar="X,Y,Z",
        ),
    ] = ""  # fmt: skip
    tolerance_mm: Annotated[
        float,
        Interval(gt=0.0, le=10.0),
        About("deviation that is reported as an error, mm; exit code 5 if there is one; solids "
              "of STEP files become triangles within a fifth of it",
              unit="mm", name="tolerance", flag="--tolerance-mm", metavar="MM"),
    ] = INCH_THOUSANDTH  # fmt: skip
    cell_mm: Annotated[
        float | None,
        Interval(ge=0.02, le=5.0),
        About("cells of the height map, mm (default: by the stock, a million cells)",
              unit="mm", name="cell", flag="--cell-mm", metavar="MM"),
    ] = None  # fmt: skip
    has_deflection: Annotated[
        bool,
        About("simulate the program, and add the predicted deflection of its tools",
              flag="--with-deflection"),
    ] = False  # fmt: skip
