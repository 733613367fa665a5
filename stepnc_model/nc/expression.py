"""Expressions and variables of NC code (``#1``, ``#<name>``, ``[#1 + 2]``), in a bounded form.

A value is known if it follows from numbers of the program alone. Everything else is NaN: a
variable that the program has not set, one of the control, division by 0, a function that is not
known here. Angles are in degrees.

References
----------
.. [1] LinuxCNC, "G-Code Overview", Expressions; Fanuc B-64604EN, Custom Macro.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from math import (
    acos,
    asin,
    atan2,
    ceil,
    cos,
    degrees,
    exp,
    floor,
    inf,
    isnan,
    log,
    nan,
    radians,
    sin,
    sqrt,
    tan,
    trunc,
)

DEEPEST = 50
"""Greatest depth of brackets within each other."""

SYSTEM = 1000
"""First number of Fanuc's variables of the control itself."""

LINUXCNC_SYSTEM = 5000
"""First number of LinuxCNC's parameters of the control itself."""

LOCAL = 33
"""First number of Fanuc's variables that subprograms share; LinuxCNC's are from 31."""

PIECE = re.compile(
    r"\s*(?:(?P<number>[0-9]+\.?[0-9]*|\.[0-9]+)|(?P<name><[^<>]*>)"
    r"|(?P<word>[a-z]+)|(?P<sign>\*\*|[-+*/#\[\],]))",
    re.IGNORECASE,
)

LEVELS: tuple[frozenset[str], ...] = (
    frozenset({"and", "or", "xor"}),
    frozenset({"eq", "ne", "gt", "ge", "lt", "le"}),
    frozenset({"+", "-"}),
    frozenset({"*", "/", "mod"}),
    frozenset({"**"}),
)
"""Operators from those that bind least to those that bind most, [1]_."""

OPERATORS: dict[str, Callable[[float, float], float]] = {
    "and": lambda a, b: float(a != 0.0 and b != 0.0),
    "or": lambda a, b: float(a != 0.0 or b != 0.0),
    "xor": lambda a, b: float((a != 0.0) is not (b != 0.0)),
    "eq": lambda a, b: float(abs(a - b) < SAME),
    "ne": lambda a, b: float(abs(a - b) >= SAME),
    "gt": lambda a, b: float(a > b),
    "ge": lambda a, b: float(a >= b),
    "lt": lambda a, b: float(a < b),
    "le": lambda a, b: float(a <= b),
    "+": lambda a, b: a + b,
    "-": lambda a, b: a - b,
    "*": lambda a, b: a * b,
    "/": lambda a, b: a / b,
    "mod": lambda a, b: a % abs(b),
    "**": lambda a, b: a**b if a >= 0.0 or b == floor(b) else nan,
}

SAME = 1e-6
"""Difference below which two numbers are equal (LinuxCNC)."""

FUNCTIONS: dict[str, Callable[[float], float]] = {
    "abs": abs,
    "acos": lambda a: degrees(acos(a)),
    "asin": lambda a: degrees(asin(a)),
    "cos": lambda a: cos(radians(a)),
    "exp": exp,
    "fix": floor,
    "fup": ceil,
    "ln": log,
    "round": lambda a: floor(a + 0.5),
    "sin": lambda a: sin(radians(a)),
    "sqrt": sqrt,
    "tan": lambda a: tan(radians(a)),
}

FANUC_FUNCTIONS: dict[str, Callable[[float], float]] = {
    **FUNCTIONS,
    "fix": trunc,
    "fup": lambda a: ceil(a) if a > 0.0 else floor(a),
}


@dataclass(slots=True)
class Variables:
    """Variables of a program, with those of each subprogram under way. Running state."""

    is_linuxcnc: bool
    shared: dict[int | str, float] = field(default_factory=dict)
    frames: list[dict[int | str, float]] = field(default_factory=lambda: [{}])
    """Local variables of the program and of each subprogram in it."""
    depths: list[bool] = field(default_factory=list)
    """Whether each call has local variables of its own."""

    def get(self, name: int | str) -> float:
        """Value of a variable; NaN where it is not known."""
        return self._frame(name).get(name, nan)

    def set(self, name: int | str, value: float) -> None:
        """Give a variable a value; those of the control itself stay unknown."""
        first = LINUXCNC_SYSTEM if self.is_linuxcnc else SYSTEM
        if isinstance(name, str) or 0 < name < first:
            self._frame(name)[name] = value

    def enter(self, arguments: dict[int | str, float] | None) -> None:
        """Enter a subprogram with its arguments; None: it has the variables of its caller."""
        self.depths.append(arguments is not None)
        if arguments is not None:
            self.frames.append(dict(arguments))

    def leave(self) -> None:
        """Return from a subprogram."""
        if self.depths and self.depths.pop():
            self.frames.pop()

    def forget(self) -> None:
        """Forget all values, as after a program that is not here."""
        self.shared.clear()
        for frame in self.frames:
            frame.clear()

    def _frame(self, name: int | str) -> dict[int | str, float]:
        if isinstance(name, str):
            return self.shared if name.startswith("_") else self.frames[-1]
        is_local = name < (31 if self.is_linuxcnc else LOCAL)
        return self.frames[-1] if is_local else self.shared


class UnreadableExpression(Exception):
    """Text that is no expression."""


def evaluate(text: str, variables: Variables) -> float:
    """Value of an expression; NaN where it is not known, or cannot be read.

    Examples
    --------
    >>> variables = Variables(is_linuxcnc=True)
    >>> variables.set(1, 10.0)
    >>> evaluate("[#1 + 2 * 3]", variables), evaluate("-#1", variables)
    (16.0, -10.0)
    >>> evaluate("#2", variables)
    nan
    """
    try:
        return _VariableReader(text, variables).whole()
    except (UnreadableExpression, ArithmeticError, ValueError):
        return nan


def target_of(text: str, variables: Variables) -> int | str | None:
    """Variable that an assignment sets, by the text before its equals sign; None: not known."""
    try:
        reader = _VariableReader(text, variables)
        reader.take("#")
        name = reader.variable()
    except (UnreadableExpression, ArithmeticError, ValueError):
        return None
    return name if reader.is_done else None


class _VariableReader:
    """Reader of one expression. Running state."""

    def __init__(self, text: str, variables: Variables) -> None:
        self._variables = variables
        self._functions = FUNCTIONS if variables.is_linuxcnc else FANUC_FUNCTIONS
        self._depth = 0
        self._pieces: list[str] = []
        at, stripped = 0, text.strip()
        while at < len(stripped):
            found = PIECE.match(stripped, at)
            if found is None:
                raise UnreadableExpression
            self._pieces.append(found[0].strip().lower())
            at = found.end()
        self._at = 0

    @property
    def is_done(self) -> bool:
        """True if the whole text is read."""
        return self._at >= len(self._pieces)

    @property
    def next(self) -> str:
        """Next piece; empty at the end."""
        return "" if self.is_done else self._pieces[self._at]

    def take(self, piece: str = "") -> str:
        """Take the next piece, which may have to be a certain one."""
        found = self.next
        if not found or (piece and found != piece):
            raise UnreadableExpression
        self._at += 1
        return found

    def whole(self) -> float:
        """Value of the whole text."""
        value = self._level(0)
        if not self.is_done or abs(value) == inf:
            raise UnreadableExpression
        return float(value)

    def _level(self, level: int) -> float:
        """Value of operators that bind at least so much."""
        if level == len(LEVELS):
            return self._unary()
        value = self._level(level + 1)
        while self.next in LEVELS[level]:
            operator = self.take()
            other = self._level(level + 1)
            is_known = not (isnan(value) or isnan(other))
            if level == 0 and not self._variables.is_linuxcnc:
                # Fanuc combines bits: only truth values are the same everywhere.
                is_known = is_known and {value, other} <= {0.0, 1.0}
            value = OPERATORS[operator](value, other) if is_known else nan
        return value

    def _unary(self) -> float:
        if self.next in {"-", "+"}:
            return -self._unary() if self.take() == "-" else self._unary()
        if self.next == "[":
            return self._bracket()
        if self.next == "#":
            self.take()
            return self._variables.get(self.variable())
        piece = self.take()
        if piece[0].isdigit() or piece[0] == ".":
            return float(piece)
        return self._function(piece)

    def _bracket(self) -> float:
        self._depth += 1
        if self._depth > DEEPEST:
            raise UnreadableExpression
        self.take("[")
        value = self._level(0)
        self.take("]")
        self._depth -= 1
        return value

    def _function(self, name: str) -> float:
        if name == "atan":
            above = self._bracket()
            self.take("/")
            below = self._bracket()
            return degrees(atan2(above, below))
        function = self._functions.get(name)
        if function is None:
            raise UnreadableExpression
        value = self._bracket()
        return nan if isnan(value) else function(value)

    def variable(self) -> int | str:
        """Number or name behind a ``#``."""
        piece = self.next
        if piece.startswith("<"):
            return self.take()[1:-1].replace(" ", "")
        if piece == "#":
            self.take()
            number = self._variables.get(self.variable())
        elif piece == "[":
            number = self._bracket()
        elif piece.isdigit():
            number = float(self.take())
        else:
            raise UnreadableExpression
        if isnan(number) or number != floor(number):
            raise UnreadableExpression
        return int(number)
