"""Small faults in Python source code, for :mod:`benchmarks.mutants`.

A fault replaces a few bytes of a statement inside a function: an operator, a number, a
condition, a returned value or the whole statement. Texts, errors that are raised, annotations
and what is told or logged stay as they are; so do numbers below 1e-5, which are tolerances.
"""

import ast
from bisect import bisect
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from random import Random

SWAPS: dict[type[ast.AST], tuple[str, ...]] = {
    ast.Lt: ("<", "<=", ">"),
    ast.LtE: ("<=", "<", ">="),
    ast.Gt: (">", ">=", "<"),
    ast.GtE: (">=", ">", "<="),
    ast.Eq: ("==", "!="),
    ast.NotEq: ("!=", "=="),
    ast.Is: ("is", "is not"),
    ast.IsNot: ("is not", "is"),
    ast.In: ("in", "not in"),
    ast.NotIn: ("not in", "in"),
    ast.And: ("and", "or"),
    ast.Or: ("or", "and"),
    ast.Add: ("+", "-"),
    ast.Sub: ("-", "+"),
    ast.Mult: ("*", "/"),
    ast.Div: ("/", "*"),
    ast.FloorDiv: ("//", "*"),
    ast.Mod: ("%", "//"),
    ast.Pow: ("**", "*"),
    ast.BitAnd: ("&", "|"),
    ast.BitOr: ("|", "&"),
}
"""operators: how one is written, and what a fault may write for it"""

TOLERANCE = 1e-5
"""smaller numbers are tolerances"""

TELLING = {"tell", "print", "debug", "info", "warn", "warning", "exception"}
"""functions that only tell somebody something"""

TYPED = {"isinstance", "cast"}
"""functions whose arguments are types"""

RETURNED = {"bool": "not ({})", "int": "({}) + 1"}
RETURNED |= dict.fromkeys(("float", "Floats"), "1.1 * ({})")
"""what is returned instead, by the annotation of the function; None from others"""

Function = ast.FunctionDef | ast.AsyncFunctionDef


@dataclass(frozen=True, slots=True, kw_only=True)
class Fault:
    """Bytes of a source code, and what a fault writes in their place."""

    begin: int
    end: int
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Mutant:
    """A source code with one fault."""

    path: str
    line: int
    before: bytes
    after: bytes

    def lines(self) -> tuple[str, str]:
        """The line as it was, and with the fault."""
        was, now = (text.decode().split("\n") for text in (self.before, self.after))
        return was[self.line - 1].strip(), now[self.line - 1].strip()


def mutants(sources: dict[str, bytes], chance: Random) -> Iterator[Mutant]:
    """Mutants in lines that are drawn, each line once; whatever is no other program is not."""
    places = {
        (path, line): found
        for path, text in sorted(sources.items())
        for line, found in faults(text).items()
    }
    for path, line in chance.sample(list(places), len(places)):
        before = sources[path]
        fault = chance.choice(places[path, line])
        after = before[: fault.begin] + fault.text.encode() + before[fault.end :]
        if _is_other_program(before, after):
            yield Mutant(path=path, line=line, before=before, after=after)


def _is_other_program(before: bytes, after: bytes) -> bool:
    try:
        compile(after, "mutant", "exec", dont_inherit=True)
    except SyntaxError:
        return False
    return ast.dump(ast.parse(before)) != ast.dump(ast.parse(after))


def faults(text: bytes) -> dict[int, list[Fault]]:
    """Possible faults of a source code by their lines."""
    found: dict[int, list[Fault]] = {}
    source = Source(text)
    for function in _functions(ast.parse(text).body):
        for fault in source.faults(function, _scope(function)):
            found.setdefault(bisect(source.starts, fault.begin), []).append(fault)
    return found


def _functions(body: Iterable[ast.AST]) -> Iterator[Function]:
    """Functions and methods that stand in no other."""
    for node in body:
        if isinstance(node, Function):
            yield node
        elif isinstance(node, ast.ClassDef):
            yield from _functions(node.body)


@dataclass(frozen=True, slots=True, kw_only=True)
class Scope:
    """Names known in the statements of a function."""

    returns: str
    rebound: frozenset[str]
    """names that have a value without one of their assignments"""


def _scope(function: Function) -> Scope:
    stored = [
        node.id
        for node in ast.walk(function)
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)
    ]
    given = [node.arg for node in ast.walk(function.args) if isinstance(node, ast.arg)]
    return Scope(
        returns=ast.unparse(function.returns) if function.returns else "",
        rebound=frozenset(each for each in stored if (stored + given).count(each) > 1),
    )


class Source:
    """Source code whose nodes know their places in it."""

    def __init__(self, text: bytes) -> None:
        self.text = text
        self.starts = [0]
        for line in text.splitlines(keepends=True):
            self.starts.append(self.starts[-1] + len(line))

    def faults(self, node: ast.AST, scope: Scope) -> Iterator[Fault]:
        """Possible faults of a node and of all within it."""
        if isinstance(node, ast.JoinedStr | ast.arguments | ast.pattern):
            return
        if _called(node) in TYPED or (isinstance(node, ast.keyword) and node.arg == "strict"):
            return
        if isinstance(node, ast.stmt) and _can_be_dropped(node, scope):
            yield self._instead(node, "pass")
        if isinstance(node, ast.Raise) or _called(node) in TELLING:
            return
        yield from self._of_itself(node, scope)
        inner = _scope(node) if isinstance(node, Function) else scope
        for name, value in ast.iter_fields(node):
            if name not in {"annotation", "returns", "decorator_list", "type_params"}:
                for each in value if isinstance(value, list) else [value]:
                    if isinstance(each, ast.AST):
                        yield from self.faults(each, inner)

    def _of_itself(self, node: ast.AST, scope: Scope) -> Iterator[Fault]:
        match node:
            case ast.Compare(left=left, ops=ops, comparators=others):
                for one, operator, other in zip((left, *others), ops, others, strict=False):
                    yield from self._swaps(operator, one, other)
            case ast.BoolOp(op=operator, values=values):
                for one, other in pairwise(values):
                    yield from self._swaps(operator, one, other)
            case ast.BinOp(left=one, op=operator, right=other) if not _is_text(one, other):
                yield from self._swaps(operator, one, other)
            case ast.AugAssign(target=one, op=operator, value=other) if not _is_text(other):
                yield from self._swaps(operator, one, other)
            case ast.Constant(value=bool() | int() | float() as value):
                yield from (self._instead(node, each) for each in _other_numbers(value))
            case ast.If(test=test) | ast.While(test=test) | ast.IfExp(test=test):
                yield self._instead(test, "not ({})")
            case ast.comprehension(ifs=ifs):
                yield from (self._instead(each, "not ({})") for each in ifs)
            case ast.Return(value=ast.expr() as value) if not isinstance(value, ast.Constant):
                yield self._instead(value, RETURNED.get(scope.returns, "None"))

    def _swaps(self, operator: ast.AST, one: ast.expr, other: ast.expr) -> Iterator[Fault]:
        """Other operators between two operands; a comment there may hide the right place."""
        was, *now = SWAPS.get(type(operator), ("\0",))
        begin = self._place(one.end_lineno, one.end_col_offset)
        end = self._place(other.lineno, other.col_offset)
        at = self.text.find(was.encode(), begin, end)
        if at >= 0:
            yield from (Fault(begin=at, end=at + len(was), text=each) for each in now)

    def _instead(self, node: ast.stmt | ast.expr, form: str) -> Fault:
        """Fault that replaces a node; braces stand for its text."""
        begin = self._place(node.lineno, node.col_offset)
        end = self._place(node.end_lineno, node.end_col_offset)
        text = form.replace("{}", self.text[begin:end].decode())
        return Fault(begin=begin, end=end, text=text)

    def _place(self, line: int | None, column: int | None) -> int:
        return self.starts[(line or 1) - 1] + (column or 0)


def _can_be_dropped(node: ast.stmt, scope: Scope) -> bool:
    """True if a statement can go without leaving a name unknown."""
    match node:
        case ast.Expr(value=ast.Call() | ast.Await()):
            return _called(node.value) not in TELLING
        case ast.Assign(targets=targets):
            return all(
                each.id in scope.rebound
                if isinstance(each, ast.Name)
                else isinstance(each, ast.Attribute | ast.Subscript)
                for each in targets
            )
        case ast.AugAssign() | ast.Raise():
            return True
    return False


def _called(node: ast.AST) -> str:
    """Last name of the function that a node calls."""
    match node:
        case ast.Call(func=ast.Name(id=name) | ast.Attribute(attr=name)):
            return name
    return ""


def _is_text(*operands: ast.expr) -> bool:
    """True if an operand is no number."""
    kinds = ast.JoinedStr | ast.List | ast.ListComp | ast.Tuple | ast.Set | ast.Dict
    return any(
        isinstance(each, kinds)
        or (isinstance(each, ast.Constant) and isinstance(each.value, str | bytes))
        for each in operands
    )


def _other_numbers(value: float) -> tuple[str, ...]:
    if isinstance(value, bool):
        return (repr(not value),)
    if isinstance(value, int):
        return (repr(value + 1), repr(value - 1)) if value else ("1",)
    if 0.0 < abs(value) < TOLERANCE:
        return ()
    return (repr(1.1 * value) if value else "1.0",)
