"""STEP-NC programs of any length: plates with a grid of pockets with islands, roughed once.

The pockets do not touch; every fourth has corners of another radius, so that no two neighbours
are alike.
"""

from collections.abc import Iterator
from math import ceil, sqrt

PITCH = (70.0, 60.0)
"""mm from pocket to pocket along x and y"""

HEAD = """ISO-10303-21;
HEADER;
FILE_DESCRIPTION(('Plate with pockets'),'2;1');
FILE_NAME('plate.stpnc','2025-01-01T00:00:00',(''),(''),'','','');
FILE_SCHEMA(('MACHINING_SCHEMA','MILLING_SCHEMA'));
ENDSEC;
DATA;
"""

COMMON = """#30=WORKPIECE('PLATE',#31,0.05,$,$,#33,());
#31=MATERIAL('C45','steel 1.1191, normalised',());
#33=BLOCK('STOCK',#34,{length},{width},30.);
#34=AXIS2_PLACEMENT_3D('STOCK CORNER',#35,#501,#502);
#35=CARTESIAN_POINT('',(0.,0.,-30.));
#40=SETUP('SETUP 1',#41,#43,(#42));
#41=AXIS2_PLACEMENT_3D('ZERO',#500,#501,#502);
#42=WORKPIECE_SETUP(#30,#41,$,$,());
#43=PLANE('SECURITY PLANE',#44);
#44=AXIS2_PLACEMENT_3D('SECURITY PLANE',#45,#501,#502);
#45=CARTESIAN_POINT('',(0.,0.,50.));
#138=TOLERANCED_LENGTH_MEASURE(0.2,#510);
#143=PLANE('POCKET: DEPTH',#144);
#144=AXIS2_PLACEMENT_3D('',#145,#501,#502);
#145=CARTESIAN_POINT('',(0.,0.,-12.));
#146=PLANAR_POCKET_BOTTOM_CONDITION();
#148=RECTANGULAR_CLOSED_PROFILE($,#149,#180);
#149=TOLERANCED_LENGTH_MEASURE(50.,#510);
#180=TOLERANCED_LENGTH_MEASURE(60.,#510);
#190=TOLERANCED_LENGTH_MEASURE(7.,#510);
#191=TOLERANCED_LENGTH_MEASURE(8.,#510);
#192=CIRCULAR_CLOSED_PROFILE($,#193);
#193=TOLERANCED_LENGTH_MEASURE(16.,#510);
#200=BOTTOM_AND_SIDE_ROUGH_MILLING($,$,'ROUGH POCKET',10.,$,#420,#304,#330,$,#342,#340,#352,
     4.,6.,0.3,0.2);
#304=MILLING_TECHNOLOGY(0.0064,.TCP.,$,-40.,$,.F.,.F.,.F.,$);
#330=MILLING_MACHINE_FUNCTIONS(.T.,$,$,.F.,$,(),.T.,$,$,());
#340=PLUNGE_TOOLAXIS($);
#342=PLUNGE_RAMP($,3.);
#352=CONTOUR_PARALLEL(0.5,.T.,.CCW.,.CLIMB.);
#420=MILLING_CUTTING_TOOL('END MILL 12MM',#421,(#423),85.,$,$);
#421=TAPERED_ENDMILL(#422,4,.RIGHT.,.F.,$,$);
#422=MILLING_TOOL_DIMENSION(12.,$,$,26.,0.2,$,$);
#423=CUTTING_COMPONENT(85.,#490,$,$,$);
#490=MATERIAL('carbide','cemented carbide, ISO 513 P20',());
#500=CARTESIAN_POINT('ORIGIN',(0.,0.,0.));
#501=DIRECTION('Z',(0.,0.,1.));
#502=DIRECTION('X',(1.,0.,0.));
#510=PLUS_MINUS_VALUE(0.1,0.1,3);
"""


def plate(pockets: int) -> str:
    """A STEP-NC program with so many pocket workingsteps."""
    return "".join(_lines(pockets))


def _lines(pockets: int) -> Iterator[str]:
    columns = ceil(sqrt(pockets))
    rows = ceil(pockets / columns)
    steps = ",".join(f"#{1000 + 10 * number}" for number in range(pockets))
    yield HEAD
    yield "#1=PROJECT('PLATE',#2,(#30),$,$,$);\n"
    yield f"#2=WORKPLAN('MAIN WORKPLAN',({steps}),$,#40,$);\n"
    yield COMMON.format(length=columns * PITCH[0] + 10.0, width=rows * PITCH[1] + 10.0)
    for number in range(pockets):
        line, column = divmod(number, columns)
        x, y = (column + 0.5) * PITCH[0] + 5.0, (line + 0.5) * PITCH[1] + 5.0
        corner = 191 if number % 4 == 3 else 190
        at = 1000 + 10 * number
        yield (
            f"#{at}=MACHINING_WORKINGSTEP('POCKET {number}',#43,#{at + 1},#200,$);\n"
            f"#{at + 1}=CLOSED_POCKET('POCKET {number}',#30,(#200),#{at + 2},#143,(#{at + 4}),"
            f"$,#146,#138,#{corner},#148);\n"
            f"#{at + 2}=AXIS2_PLACEMENT_3D('',#{at + 3},#501,#502);\n"
            f"#{at + 3}=CARTESIAN_POINT('',({x},{y},0.));\n"
            f"#{at + 4}=BOSS('ISLAND',#30,(),#{at + 2},#143,#192,$);\n"
        )
    yield "ENDSEC;\nEND-ISO-10303-21;\n"
