"""Guess of the control and the kind of machine that NC code was written for.

Each hint in the first part of a file gives points to a control; the most points win. Without
hints LinuxCNC is taken, whose code is the plainest.
"""

import re
from codecs import BOM_UTF8
from dataclasses import dataclass

from stepnc_model.post.blocks import MachineType
from stepnc_model.post.dialect import Dialect

LOOKED_AT = 200_000
"""Bytes at the beginning of a file that are looked at."""

COMMENTS = re.compile(rb"\([^)\r\n]*\)?|;[^\r\n]*")

HINTS: tuple[tuple[Dialect, int, bytes], ...] = (
    (Dialect.HEIDENHAIN, 20, rb"^[ \t]*(?:0[ \t]+)?BEGIN PGM\b"),
    (
        Dialect.HEIDENHAIN,
        5,
        rb"^[ \t]*(?:[0-9]+[ \t]+)?(?:TOOL CALL|CYCL DEF|LBL |CC |BLK FORM)",
    ),
    (Dialect.HEIDENHAIN, 5, rb"^[ \t]*(?:[0-9]+[ \t]+)?L [XYZI].*\b(?:FMAX|R0)\b"),
    (Dialect.SINUMERIK, 20, rb"^[ \t]*%_N_\w+_(?:MPF|SPF)"),
    (
        Dialect.SINUMERIK,
        5,
        rb"\b(?:MCALL|CYCLE8[0-9]+\(|CYCLE800|SUPA|DIAMON|DIAMOF|TRANS |MSG\(|WORKPIECE\b)",
    ),
    (
        Dialect.SINUMERIK,
        4,
        rb"\b(?:CR|TURN|LIMS|RND|CHF|CHR|SPOS|T|R[0-9]+)[ \t]*=[ \t]*[-+\"0-9]",
    ),
    (Dialect.SINUMERIK, 4, rb"\bG(?:710|700|500|64[1-5]|50[5-9])\b"),
    (Dialect.SINUMERIK, 3, rb"[XYZIJK]=(?:IC|AC)\("),
    (
        Dialect.LINUXCNC,
        10,
        rb"^[ \t]*o(?:[0-9]+|<[^>]*>)[ \t]*(?:sub|call|if|while|repeat|do)\b",
    ),
    (
        Dialect.LINUXCNC,
        6,
        rb"#<[^>\r\n]*>|\bG(?:91\.1|90\.1|64[ \t]*P|33\.1|38\.[2-5]|43\.1|92\.1)",
    ),
    (Dialect.LINUXCNC, 3, rb"\bG9[0-9]\.[0-9]|\bG[78]\b"),
    (Dialect.HAAS, 8, rb"^O[0-9]{5}\b"),
    (Dialect.HAAS, 5, rb"\b(?:G154[ \t]*P|M97[ \t]*P|G187|G103|M88|M89|G1[23]\b)"),
    (Dialect.FANUC, 7, rb"^(?::|O)[0-9]{4}\b(?![0-9])"),
    (Dialect.FANUC, 3, rb"\b(?:M98[ \t]*P|G65[ \t]*P|G5\.1|G05\.1|G54\.1|M29|G10 L2)"),
    (Dialect.FANUC, 3, rb"\bT[0-9]{4}\b|^[ \t]*(?:N[0-9]+[ \t]*)?G50[ \t]*S"),
)
_COMPILED = tuple((d, points, re.compile(text, re.M | re.I)) for d, points, text in HINTS)
_IN_COMMENTS = (
    (Dialect.HAAS, 4, re.compile(rb"\bhaas\b", re.I)),
    (Dialect.FANUC, 4, re.compile(rb"\bfanuc\b", re.I)),
    (Dialect.LINUXCNC, 4, re.compile(rb"\b(?:linuxcnc|emc2?|grbl|freecad)\b", re.I)),
)

Y_WORDS = re.compile(rb"\bY[ \t]*=?[-+]?[0-9.]|[0-9.]Y[-+]?[0-9.]", re.I)
LATHE_HINTS = re.compile(
    rb"\bT(?!0000)[0-9]{4}\b|\bG50[ \t]*S[0-9]|\bG96\b|\bLIMS[ \t]*=|\bDIAMON\b"
    rb"|\bG[78]\b(?![ \t]*[0-9.])|\bG0?[0123][ \t]*U-?[0-9.]",
    re.I,
)
MILL_HINTS = re.compile(
    rb"\bM0?6\b|\bG43\b|\bG8[1235]\b|\bG17\b|TOOL CALL|\bY[-+=]?[0-9.]|\bG41\b[ \t]*D", re.I
)


@dataclass(frozen=True, slots=True, kw_only=True)
class RecognisedControl:
    """Control and kind of machine that NC code seems to be for."""

    dialect: Dialect
    machine: MachineType
    hints: tuple[str, ...]
    """Pieces of the program that speak for the control."""


def recognise(data: bytes) -> RecognisedControl:
    r"""Guess the control of NC code from its beginning.

    Examples
    --------
    >>> recognise(b"%\nO1234 (PART)\nG21 G54\nT1 M6\n").dialect.value
    'fanuc'
    """
    head = data[:LOOKED_AT].removeprefix(BOM_UTF8)
    code = COMMENTS.sub(b" ", head)
    points: dict[Dialect, int] = {d: 0 for d in Dialect if d is not Dialect.CANONICAL}
    hints: dict[Dialect, list[str]] = {dialect: [] for dialect in points}
    for found_in, patterns in ((code, _COMPILED), (head, _IN_COMMENTS)):
        for dialect, worth, pattern in patterns:
            found = pattern.search(found_in)
            if found is not None:
                points[dialect] += worth
                hints[dialect].append(found[0].decode("latin-1").strip())
    best = max(points, key=lambda dialect: points[dialect])
    is_lathe = best is not Dialect.HEIDENHAIN and _is_for_lathe(code)
    return RecognisedControl(
        dialect=best,
        machine=MachineType.LATHE if is_lathe else MachineType.MILL,
        hints=tuple(hints[best]),
    )


def _is_for_lathe(code: bytes) -> bool:
    """True if code without Y words has words of lathes, or more of them than of mills."""
    turned = _count(LATHE_HINTS, code)
    if turned and not Y_WORDS.search(code):
        return True
    return turned > _count(MILL_HINTS, code)


def _count(pattern: re.Pattern[bytes], code: bytes) -> int:
    return sum(1 for _ in pattern.finditer(code))
