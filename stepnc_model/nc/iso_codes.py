"""G and M codes by control: what they do to position, coordinates and feed.

After Fanuc B-64604EN, Haas "Mill Operator's Manual" and "Lathe Operator's Manual", LinuxCNC
"G-Code reference" and Siemens "SINUMERIK 840D sl Fundamentals". Codes are in tenths. Codes that
are in no table may move the machine: what follows is not understood before all axes have
absolute positions again.
"""

from stepnc_model.post.dialect import Dialect
from stepnc_model.toolpath.path import ArcPlane, CycleKind

PLANES = {170: ArcPlane.XY, 180: ArcPlane.ZX, 190: ArcPlane.YZ}
INCHES, METRIC = {200}, {210}
SINUMERIK_INCHES, SINUMERIK_METRIC = {700, 7000}, {710, 7100}

FRAMES = {540, 550, 560, 570, 580, 590}
FRAMES_BY_CONTROL: dict[Dialect, frozenset[int]] = {
    Dialect.LINUXCNC: frozenset({*FRAMES, 591, 592, 593}),
    Dialect.FANUC: frozenset(FRAMES),
    Dialect.HAAS: frozenset({*FRAMES, *range(1100, 1300, 10)}),
    Dialect.SINUMERIK: frozenset({540, 550, 560, 570, 5000, *range(5050, 6000, 10)}),
}
NUMBERED_FRAMES = {541, 1540}
"""G54.1 and G154, whose P word counts the frame."""

HARMLESS = {90, 400, 410, 420, 490, 610, 611, 640, 800, 900, 910, 940, 950, 960, 970, 980, 990}
"""Codes that all controls know and that move nothing; some have actions of their own."""

HARMLESS_BY_CONTROL: dict[Dialect, frozenset[int]] = {
    Dialect.LINUXCNC: frozenset({431, 432, 901, 911}),
    Dialect.FANUC: frozenset({
        *{50, 51, 80, 81, 110, 131, 150, 151, 220, 230, 250, 260, 500, 501, 620, 630, 690},
    }),
    Dialect.HAAS: frozenset({150, 500, 501, 690, 1030, 1170, 1130, 1870}),
    Dialect.SINUMERIK: frozenset({
        *{600, 6010, 6020, 6030, 6410, 6420, 6430, 6440, 6450, 640},
        *{4500, 4510, 4600, 4610, 4620, 3400, 3410, 1400, 1410, 1420, 1430, 2470},
        *{250, 260, 9610, 9620, 9710, 9720, 9730},
    }),
}

TRANSFORMS_ON = {
    Dialect.LINUXCNC: frozenset[int](),
    Dialect.FANUC: frozenset({
        160,
        510,
        511,
        680,
        682,
        683,
        684,
        121,
        1120,
        71,
        1070,
        434,
        435,
    }),
    Dialect.HAAS: frozenset({510, 511, 1010, 680, 1120, 1070, 2340, 2540, 1410}),
    Dialect.SINUMERIK: frozenset[int](),
}
TRANSFORMS_OFF = {
    Dialect.LINUXCNC: frozenset[int](),
    Dialect.FANUC: frozenset({150, 500, 501, 690, 131, 1130}),
    Dialect.HAAS: frozenset({500, 501, 1000, 690, 1130, 2350, 2550}),
    Dialect.SINUMERIK: frozenset[int](),
}

CENTRED_TRANSFORMS = {500, 501, 510, 511, 680, 682, 683, 684, 1000, 1010}
"""Codes of these whose axis words name a centre or an axis, and move nothing."""

LENGTHS = {430, 431, 432, 440, 490}
"""Tool length offset on or off: z of the program is known again at its next position."""

CANNED = {
    730: CycleKind.CHIP_BREAK,
    740: CycleKind.TAP,
    810: CycleKind.DRILL,
    820: CycleKind.DWELL,
    830: CycleKind.PECK,
    840: CycleKind.TAP,
    850: CycleKind.BORE,
    860: CycleKind.BORE_STOP,
    890: CycleKind.BORE,
}
UNKNOWN_CYCLES = {760, 870, 880}
"""Fine and back boring: they move sideways at the bottom."""

LATHE_CYCLES = {700, 710, 720, 730, 740, 750, 760, 830, 840, 850, 870, 880, 890, 900, 920, 940}
"""Turning and drilling cycles of lathes, which are not expanded."""

END_FUNCTIONS: dict[Dialect, frozenset[int]] = {
    Dialect.LINUXCNC: frozenset({0, 10, 20, 300, 600}),
    Dialect.FANUC: frozenset({0, 10, 20, 50, 90, 300, 890}),
    Dialect.HAAS: frozenset({0, 10, 20, 50, 90, 300, 890}),
    Dialect.SINUMERIK: frozenset({0, 10, 20, 50, 90, 300, 170}),
    Dialect.HEIDENHAIN: frozenset({0, 10, 20, 50, 90, 300}),
}
"""M codes that act after the move of their block."""

START_FUNCTIONS = frozenset({30, 40, 70, 80, 130, 140, 880})
"""M codes that act before the move of their block: spindle and coolant on."""

KNOWN_FUNCTIONS = START_FUNCTIONS | {0, 10, 20, 50, 60, 90, 300, 290, 190, 170, 480, 490, 520,
                                     890, 400, 410, 420, 430, 440, 600}  # fmt: skip

SINUMERIK_QUIET = frozenset({
    *{"SOFT", "BRISK", "DRIVE", "FFWON", "FFWOF", "COMPON", "COMPOF", "COMPCAD", "COMPCURV"},
    *{"CFC", "CFTCP", "CFIN", "STOPRE", "KONT", "KONTC", "NORM", "UPATH", "SPATH", "FIFOCTRL"},
    *{"STARTFIFO", "WALIMON", "WALIMOF", "CDON", "CDOF", "OSS", "OSOF", "MSG", "WORKPIECE"},
    *{"ORIWKS", "ORIMKS", "ORIAXES", "DIAMON", "DIAMOF", "DIAM90", "SUPA", "G", "CYCLE832"},
    *{"FGREF", "FGROUP", "RTLION", "RTLIOF", "TRAFOOF", "ADIS", "ADISPOS", "CUT2D", "CIP"},
}) - {"G", "CIP"}
"""Keywords that do not move an axis."""

SINUMERIK_TRANSFORMS = frozenset({
    *{"ROT", "AROT", "SCALE", "ASCALE", "MIRROR", "AMIRROR", "ROTS", "AROTS", "RPL"},
    *{"TRAORI", "TRANSMIT", "TRACYL", "TRAANG", "CYCLE800", "TOFRAME", "TOROT", "PAROT"},
})
"""Keywords that rotate, scale, mirror or tilt the coordinates."""
