"""Programs that the tests send."""

from pathlib import Path

PARTS = Path(__file__).parents[3] / "examples" / "parts"

SAMPLE = PARTS / "paper002.stpnc"
"""a few seconds of machining"""

SLOT = PARTS / "paper003_case1.stpnc"
"""a slot, which has walls"""

CODE = b"""%
O0001 (PLATE)
G21 G17 G90 G94 G54
T1 M6
S2000 M3
G0 G43 H1 Z20.
G5.1 Q1
G0 X-15. Y10.
G0 Z-2.
G1 X115. F300.
G0 Z20.
G0 X-15. Y40.
G0 Z-2.
G1 X60. F300.
Y30.
X115.
G0 Z20.
M5
M30
%
"""
"""NC code of two passes over a plate"""

CODE_TOOLS = (
    b"number,id,kind,diameter_mm,teeth,edge_length_mm,overhang_mm,holder_diameter_mm\n"
    b"1,END MILL 10,endmill,10,4,22,40,20\n"
)
"""the tool of the code"""

CODE_STOCK = "0,0,-20,100,50,0"
"""its raw part, mm"""
