"""Expressions with R parameters of Sinumerik (``R2+5``) and Q parameters of Klartext.

A value is known if it follows from numbers of the program alone, as in
:mod:`stepnc_model.nc.expression`; everything else is NaN. Angles are in degrees.

References
----------
.. [1] Siemens, "SINUMERIK 840D sl Job Planning", arithmetic parameters and functions.
.. [2] Heidenhain, "iTNC 530 User's Manual, Conversational Programming", Q parameters: those
   from Q100 to Q199 have values of the control.
"""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from math import (
    acos,
    asin,
    atan,
    atan2,
    cos,
    degrees,
    exp,
    floor,
    fmod,
    hypot,
    inf,
    isnan,
    log,
    log10,
    nan,
    pi,
    radians,
    sin,
    sqrt,
    tan,
    trunc,
)

from stepnc_model.nc.expression import DEEPEST, OPERATORS, UnreadableExpression

PIECE = re.compile(
    r"\s*(?:(?P<number>[0-9]+\.?[0-9]*|\.[0-9]+)|(?P<variable>(?:R|Q[LR]?)[0-9]+)"
    r"|(?P<word>[a-z_][a-z_]*(?:[0-9]+(?:_[a-z0-9_]*)?)?)|(?P<sign>==|<>|>=|<=|[-+*/^()<>,]))",
    re.IGNORECASE,
)

OF_CONTROL = re.compile(r"Q0*1[0-9][0-9]")
"""Parameters whose values come from the control."""

Operator = Callable[[float, float], float]
Function = Callable[[float], float]

COMPARED: Mapping[str, Operator] = {
    "==": OPERATORS["eq"],
    "<>": OPERATORS["ne"],
    ">": OPERATORS["gt"],
    ">=": OPERATORS["ge"],
    "<": OPERATORS["lt"],
    "<=": OPERATORS["le"],
}
SUMS = {"+": OPERATORS["+"], "-": OPERATORS["-"]}
BOTH: Mapping[str, Function] = {
    "ABS": abs,
    "ACOS": lambda a: degrees(acos(a)),
    "ASIN": lambda a: degrees(asin(a)),
    "COS": lambda a: cos(radians(a)),
    "EXP": exp,
    "LN": log,
    "SIN": lambda a: sin(radians(a)),
    "SQRT": sqrt,
    "TAN": lambda a: tan(radians(a)),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Arithmetic:
    """Operators, from those that bind least, and functions of a control."""

    levels: tuple[Mapping[str, Operator], ...]
    functions: Mapping[str, Function]


SINUMERIK = Arithmetic(
    levels=(
        COMPARED,
        {"OR": OPERATORS["or"]},
        {"XOR": OPERATORS["xor"]},
        {"AND": OPERATORS["and"]},
        SUMS,
        {
            **{"*": OPERATORS["*"], "/": OPERATORS["/"]},
            **{"DIV": lambda a, b: float(trunc(a / b)), "MOD": fmod},
        },
    ),
    functions={
        **BOTH,
        "POT": lambda a: a * a,
        "ROUND": lambda a: floor(a + 0.5),
        "TRUNC": lambda a: float(trunc(a)),
    },
)
KLARTEXT = Arithmetic(
    levels=(
        {
            **{"EQU": OPERATORS["eq"], "NE": OPERATORS["ne"]},
            **{"GT": OPERATORS["gt"], "LT": OPERATORS["lt"]},
        },
        SUMS,
        {
            **{"*": OPERATORS["*"], "/": OPERATORS["/"], "DIV": OPERATORS["/"]},
            **{"LEN": hypot, "ANG": lambda a, b: degrees(atan2(a, b)) % 360.0},
        },
        {"^": OPERATORS["**"]},
    ),
    functions={
        **BOTH,
        "ATAN": lambda a: degrees(atan(a)),
        "FRAC": lambda a: a - trunc(a),
        "INT": lambda a: float(trunc(a)),
        "LOG": log10,
        "NEG": lambda a: -a,
        "SGN": lambda a: float((a > 0.0) - (a < 0.0)),
        "SQ": lambda a: a * a,
    },
)


@dataclass(slots=True)
class Parameters:
    """Parameters of one program. Running state."""

    arithmetic: Arithmetic
    values: dict[str, float] = field(default_factory=dict)
    declared: set[str] = field(default_factory=set)
    """Names of variables that the program defines, in capitals."""

    def get(self, name: str) -> float:
        """Value of a parameter; NaN where it is not known."""
        return self.values.get(plain_name(name), nan)

    def set(self, name: str, value: float) -> None:
        """Give a parameter a value; those of the control stay unknown."""
        plain = plain_name(name)
        if not OF_CONTROL.fullmatch(plain):
            self.values[plain] = value

    def declare(self, name: str, value: float) -> None:
        """Define a variable of the program, with its first value."""
        self.declared.add(name.upper())
        self.set(name, value)

    def forget(self) -> None:
        """Forget all values, as after a program that is not here."""
        self.values.clear()

    def evaluate(self, text: str) -> float:
        """Value of an expression; NaN where it is not known, or cannot be read.

        Examples
        --------
        >>> parameters = Parameters(SINUMERIK, {"R1": 10.0})
        >>> parameters.evaluate("(R1+2)/2"), parameters.evaluate("-R1")
        (6.0, -10.0)
        >>> parameters.evaluate("R2")
        nan
        """
        try:
            value = _ParameterReader(text, self).whole()
        except (UnreadableExpression, ArithmeticError, ValueError):
            return nan
        return nan if abs(value) == inf else value


def plain_name(name: str) -> str:
    """Name of a parameter without zeros before its number."""
    letters = name.rstrip("0123456789").upper()
    number = name[len(letters) :]
    return f"{letters}{int(number)}" if number else letters


class _ParameterReader:
    """Reader of one expression. Running state."""

    def __init__(self, text: str, parameters: Parameters) -> None:
        self._parameters, self._arithmetic = parameters, parameters.arithmetic
        self._pieces: list[tuple[str, str]] = []
        self._at = self._depth = 0
        at, stripped = 0, text.strip().upper()
        while at < len(stripped):
            found = PIECE.match(stripped, at)
            if found is None:
                raise UnreadableExpression
            self._pieces.append((found.lastgroup or "", found[found.lastgroup or 0]))
            at = found.end()

    @property
    def next(self) -> str:
        """Next piece; empty at the end."""
        return self._pieces[self._at][1] if self._at < len(self._pieces) else ""

    def whole(self) -> float:
        """Value of the whole text."""
        value = self._level(0)
        if self.next:
            raise UnreadableExpression
        return float(value)

    def _level(self, level: int) -> float:
        """Value of operators that bind at least so much."""
        if level == len(self._arithmetic.levels):
            return self._signed()
        operators = self._arithmetic.levels[level]
        value = self._level(level + 1)
        while self.next in operators:
            operator = operators[self._take()]
            other = self._level(level + 1)
            value = nan if isnan(value) or isnan(other) else operator(value, other)
        return value

    def _signed(self) -> float:
        self._depth += 1
        if self._depth > DEEPEST:
            raise UnreadableExpression
        value = self._operand()
        self._depth -= 1
        return value

    def _operand(self) -> float:
        if self.next in {"+", "-"}:
            return self._signed() if self._take() == "+" else -self._signed()
        if self.next == "(":
            return self._inside(1)[0]
        kind = self._pieces[self._at][0] if self.next else ""
        piece = self._take()
        if kind == "number":
            return float(piece)
        if kind == "variable":
            return self._parameters.get(piece)
        return self._named(piece)

    def _named(self, name: str) -> float:
        """Value of a constant or a function, whose argument may have no brackets."""
        if name == "PI":
            return pi
        if name == "ATAN2" and self._arithmetic is SINUMERIK:
            above, below = self._inside(2)
            return degrees(atan2(above, below))
        if name in self._parameters.declared:
            return self._parameters.get(name)
        function = self._arithmetic.functions.get(name)
        if function is None or (self._arithmetic is SINUMERIK and self.next != "("):
            raise UnreadableExpression
        value = self._signed()
        return nan if isnan(value) else function(value)

    def _inside(self, count: int) -> list[float]:
        """Values in brackets."""
        self._require("(")
        values = [self._level(0)]
        while len(values) < count:
            self._require(",")
            values.append(self._level(0))
        self._require(")")
        return values

    def _require(self, piece: str) -> None:
        if self._take() != piece:
            raise UnreadableExpression

    def _take(self) -> str:
        piece = self.next
        if not piece:
            raise UnreadableExpression
        self._at += 1
        return piece
