"""Raw part that an NC program itself states.

Klartext: ``BLK FORM 0.1`` and ``0.2``, the least and the greatest corner of a box, and ``BLK
FORM CYLINDER``. Sinumerik: ``WORKPIECE(,,,"BOX",112,ZA,ZI,ZB,X1,Y1,X2,Y2)``, ``"RECTANGLE"``
about zero and ``"CYLINDER"``. Others: the comment ``(STOCK/BLOCK,X,Y,Z,OX,OY,OZ)``, the size of
a box and the place of the program's zero in it, as posts write it for viewers of NC code.

Forms that are not read, and statements that contradict each other, are told.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass

from stepnc_model.errors import Finding, Severity
from stepnc_model.nc.program import NcProgram
from stepnc_model.post.blocks import MachineType
from stepnc_model.post.dialect import Dialect
from stepnc_model.programs.program import Stock

_NUMBER = rb"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)"

_FORM = re.compile(rb"^[ \t]*(?:[0-9]+[ \t]+)?BLK[ \t]+FORM[ \t]+([^\r\n;]*)", re.I | re.M)
_AXIS = re.compile(rb"(I?)([XYZ])[ \t]*(" + _NUMBER + rb")", re.I)
_ROUND = re.compile(
    rb"CYLINDER[ \t]+Z[ \t]+([RD])[ \t]*(" + _NUMBER + rb")[ \t]+L[ \t]*(" + _NUMBER
    + rb")(?:[ \t]+DIST[ \t]*(" + _NUMBER + rb"))?(?![^\r\n]*\bRI)", re.I,
)  # fmt: skip
_WORKPIECE = re.compile(rb"^[^;(\r\n]*\bWORKPIECE[ \t]*\(([^)\r\n]*)\)", re.I | re.M)
_BLOCK = re.compile(rb"[(;][ \t]*STOCK[ \t]*/[ \t]*BLOCK[ \t]*,([^)\r\n]*)", re.I)

IS_X_ABSOLUTE, IS_Y_ABSOLUTE, IS_Z_ABSOLUTE = 16, 32, 64
"""Bits of the fifth argument of WORKPIECE: that the second corner and the end along Z are
coordinates, not distances from the first; 112 has all of them."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StatedStock:
    """Raw part of a program."""

    stock: Stock | None
    """Box or upright bar, mm; None if the program states none that is read."""
    line: int = 0
    findings: tuple[Finding, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class _Statement:
    """One statement: its stock, or why it is not read."""

    offset: int
    stock: Stock | None
    why: str = ""


def stated_stock(program: NcProgram) -> StatedStock:
    r"""Read the raw part that a program states.

    Parameters
    ----------
    program : NcProgram

    Examples
    --------
    >>> from stepnc_model.nc.program import read_program
    >>> data = b"(STOCK/BLOCK,100,80,20,50,40,20)\nG21 G90\nG1 X1 F100\n"
    >>> stated_stock(read_program(data)).stock
    Stock(low=(-50.0, -40.0, -20.0), high=(50.0, 40.0, 0.0), radius=None, is_around=False)
    """
    statements = list(_statements(program))
    stocks = [each for each in statements if each.stock is not None]
    findings = [
        _warning(f"the stock of the program is not read: {each.why}", _line(program, each))
        for each in statements
        if each.stock is None
    ]
    if not stocks:
        return StatedStock(stock=None, findings=tuple(findings))
    first = stocks[0]
    other = next((each for each in stocks if each.stock != first.stock), None)
    if other is not None:
        why = f"the program states another stock on line {_line(program, other)}: none is taken"
        return StatedStock(
            stock=None, findings=(*findings, _warning(why, _line(program, first)))
        )
    return StatedStock(stock=first.stock, line=_line(program, first), findings=tuple(findings))


def _statements(program: NcProgram) -> Iterator[_Statement]:
    data, unit = program.text.data, program.unit
    if program.dialect is Dialect.HEIDENHAIN:
        yield from _forms(data, unit)
    elif program.dialect is Dialect.SINUMERIK:
        is_lathe = program.machine is MachineType.LATHE
        for found in _WORKPIECE.finditer(data):
            yield _workpiece(found, unit, is_lathe=is_lathe)
    for found in _BLOCK.finditer(data):
        yield _block(found, unit)


def _forms(data: bytes, unit: float) -> Iterator[_Statement]:
    """Statements of Klartext; the least corner waits for the greatest."""
    low: tuple[int, dict[str, float]] | None = None
    for found in _FORM.finditer(data):
        text = found[1].strip().upper()
        if text.startswith(b"0.1"):
            low = found.start(), _axes(text[3:], {})
        elif text.startswith(b"0.2"):
            if low is None:
                yield _Statement(offset=found.start(), stock=None, why="it has no BLK FORM 0.1")
                continue
            at, corner = low
            yield _box(at, corner, _axes(text[3:], corner), unit)
        elif around := _ROUND.match(text):
            yield _cylinder(found.start(), around, unit)
        else:
            named = text.decode("latin-1")[:40]
            yield _Statement(offset=found.start(), stock=None, why=f"BLK FORM {named}")


def _axes(text: bytes, start: dict[str, float]) -> dict[str, float]:
    """Coordinates of a corner; those with I are distances from another corner."""
    found = {}
    for each in _AXIS.finditer(text):
        axis = each[2].decode().upper()
        found[axis] = float(each[3]) + (start.get(axis, 0.0) if each[1] else 0.0)
    return found


def _box(offset: int, low: dict[str, float], high: dict[str, float], unit: float) -> _Statement:
    """Box between two corners."""
    if not set("XYZ") <= set(low) & set(high):
        return _Statement(offset=offset, stock=None, why="a corner has not all of X, Y and Z")
    one, other = ([unit * corner[axis] for axis in "XYZ"] for corner in (low, high))
    return _stock(offset, one, other)


def _stock(offset: int, one: list[float], other: list[float]) -> _Statement:
    """Box between two corners, mm."""
    if any(abs(a - b) <= 0.0 for a, b in zip(one, other, strict=True)):
        return _Statement(offset=offset, stock=None, why="it has no volume")
    pairs = list(zip(one, other, strict=True))
    return _Statement(
        offset=offset,
        stock=Stock(
            low=(min(pairs[0]), min(pairs[1]), min(pairs[2])),
            high=(max(pairs[0]), max(pairs[1]), max(pairs[2])),
        ),
    )


def _cylinder(offset: int, found: re.Match[bytes], unit: float) -> _Statement:
    """Upright bar of Klartext about zero; DIST is the height of its top over zero."""
    size = float(found[2]) * unit
    radius = size if found[1].upper() == b"R" else 0.5 * size
    top = float(found[4] or 0.0) * unit
    return _bar(offset, radius, (top - abs(float(found[3])) * unit, top))


def _bar(offset: int, radius: float, ends: tuple[float, float]) -> _Statement:
    if radius <= 0.0 or ends[0] == ends[1]:
        return _Statement(offset=offset, stock=None, why="it has no volume")
    return _Statement(
        offset=offset,
        stock=Stock(
            low=(-radius, -radius, min(ends)), high=(radius, radius, max(ends)), radius=radius
        ),
    )


def _workpiece(found: re.Match[bytes], unit: float, *, is_lathe: bool) -> _Statement:
    """Raw part of Sinumerik's WORKPIECE."""
    offset = found.start()
    given = [each.strip().strip(b'"').decode("latin-1") for each in found[1].split(b",")]
    kind = given[3].upper() if len(given) > 3 else ""
    try:
        mask = int(float(given[4] or 0))
        numbers = [float(each or 0.0) * unit for each in given[5:]]
    except (IndexError, ValueError):
        return _Statement(
            offset=offset, stock=None, why="WORKPIECE with values that are no numbers"
        )
    if is_lathe and kind != "CYLINDER":
        return _Statement(offset=offset, stock=None, why=f'WORKPIECE "{kind}" on a lathe')
    counts = {"BOX": 7, "RECTANGLE": 5, "CYLINDER": 4}
    if len(numbers) < counts.get(kind, len(numbers) + 1):
        return _Statement(offset=offset, stock=None, why=f'WORKPIECE "{kind}"')
    top, bottom = numbers[:2]
    if not mask & IS_Z_ABSOLUTE:
        bottom += top
    if kind == "CYLINDER":
        return _bar(offset, 0.5 * numbers[3], (bottom, top))
    if kind == "RECTANGLE":
        x, y = 0.5 * numbers[3], 0.5 * numbers[4]
        return _stock(offset, [-x, -y, bottom], [x, y, top])
    x0, y0, x1, y1 = numbers[3:7]
    x1 += 0.0 if mask & IS_X_ABSOLUTE else x0
    y1 += 0.0 if mask & IS_Y_ABSOLUTE else y0
    return _stock(offset, [x0, y0, bottom], [x1, y1, top])


def _block(found: re.Match[bytes], unit: float) -> _Statement:
    """Box of a comment: its size, and the place of the program's zero in it."""
    try:
        numbers = [float(each) * unit for each in found[1].split(b",")]
    except ValueError:
        numbers = []
    if len(numbers) != 6:
        why = "STOCK/BLOCK without six numbers"
        return _Statement(offset=found.start(), stock=None, why=why)
    size, place = numbers[:3], numbers[3:]
    low = [-each for each in place]
    return _stock(found.start(), low, [a + b for a, b in zip(low, size, strict=True)])


def _line(program: NcProgram, statement: _Statement) -> int:
    return program.text.data.count(b"\n", 0, statement.offset) + 1


def _warning(message: str, line: int) -> Finding:
    return Finding(severity=Severity.WARNING, message=message, line=line)
