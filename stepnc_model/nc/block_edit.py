"""Change of the F word of a block, and division of a block into several.

What is not changed stays character for character. The first piece keeps the block number, the
comments, and the words that act before the move; the last piece gets the functions that act
after it.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal

from stepnc_model.nc import iso_codes
from stepnc_model.nc.number_style import NumberStyle
from stepnc_model.nc.split import MovePiece, WordScale
from stepnc_model.nc.token import NUMBER, Token, TokenKind, tokens
from stepnc_model.post.dialect import Dialect

AXES = {"X": 0, "Y": 1, "Z": 2, "U": 0, "W": 2, "IX": 0, "IY": 1, "IZ": 2}
RELATIVE = {"U", "W", "IX", "IY", "IZ"}
CENTRES = {"I": 0, "J": 1, "K": 2}
FEEDS = {"F", "FU"}
RADII = {Dialect.SINUMERIK: "CR"}
TURNS = {Dialect.LINUXCNC: ("P", 0), Dialect.SINUMERIK: ("TURN", 1)}
"""Word that counts the turns of an arc, and the turns beyond its number."""
KLARTEXT_HEADS = {"L", "C", "CR"}
KLARTEXT_KEPT = KLARTEXT_HEADS | {"DR+", "DR-"}
BEFORE_FEED = {"R0", "RL", "RR", "DR+", "DR-", "FMAX"}


@dataclass(frozen=True, slots=True, kw_only=True)
class BlockForm:
    """Form of the move of a block, by the modal state."""

    dialect: Dialect
    style: NumberStyle
    scale: WordScale
    is_relative: bool
    is_centre_absolute: bool
    axes: tuple[int, ...]
    """Axes that move, and both axes of an arc's plane."""
    arc: tuple[int, ...] = ()
    """Axes of the plane of an arc."""


def feed_token(text: str, dialect: Dialect) -> Token | None:
    """F word of a block, or None."""
    if "F" not in text and "f" not in text:
        return None
    for token in tokens(text, dialect):
        if token.name in FEEDS and token.kind in {TokenKind.WORD, TokenKind.MACRO}:
            return token
    return None


CYCLE_FEED = "Q206"
"""Parameter of a Klartext cycle that holds its feed."""


def cycle_feed_token(text: str, dialect: Dialect) -> Token | None:
    """Word of a block that gives a defined cycle its feed, or None without a number there."""
    if dialect is not Dialect.HEIDENHAIN:
        token = feed_token(text, dialect)
        return token if token is not None and token.kind is TokenKind.WORD else None
    for token in tokens(text, dialect):
        is_feed = token.kind is TokenKind.ASSIGNMENT and token.name == CYCLE_FEED
        if is_feed and re.fullmatch(NUMBER, token.value):
            return token
    return None


def with_cycle_feed(text: str, feed: str, *, dialect: Dialect) -> str:
    """Block with another feed of the cycle that it defines, or that is called after it.

    Examples
    --------
    >>> with_cycle_feed("CYCL DEF 200 Q206=+150 ~", "80", dialect=Dialect.HEIDENHAIN)
    'CYCL DEF 200 Q206=80 ~'
    """
    token = cycle_feed_token(text, dialect)
    if token is None:
        return text
    return text[: token.end - len(token.value)] + feed + text[token.end :]


def with_feed(text: str, feed: str, *, dialect: Dialect, gap: str) -> str:
    """Block with a feed: its F word is replaced, or one is inserted after its coordinates.

    Parameters
    ----------
    text : str
        Block with its line end.
    feed : str
        Number of the F word, or a whole word where it begins with a letter.
    dialect : Dialect
    gap : str
        Text before an inserted word.

    Examples
    --------
    >>> with_feed("N1 G1 X5. F100. (slot)", "80.", dialect=Dialect.FANUC, gap=" ")
    'N1 G1 X5. F80. (slot)'
    >>> with_feed("X7. M8", "80.", dialect=Dialect.FANUC, gap=" ")
    'X7. F80. M8'
    """
    token = feed_token(text, dialect)
    word = feed if feed[:1].isalpha() else f"F{feed}"
    if token is not None:
        if feed[:1].isalpha():
            return text[: token.start] + word + text[token.end :]
        head = text[token.start : token.end - len(token.value)]
        return text[: token.start] + head + feed + text[token.end :]
    at = _insertion(text, dialect)
    return text[:at] + gap + word + text[at:]


def _insertion(text: str, dialect: Dialect) -> int:
    """Place behind the last coordinate, where an F word belongs."""
    behind = 0
    last = 0
    for token in tokens(text, dialect):
        is_word = token.kind in {TokenKind.WORD, TokenKind.MACRO}
        is_geometry = is_word and token.name not in {"M", "N", "S", "T", "H", "D"}
        if is_geometry or (token.kind is TokenKind.NAME and token.name in BEFORE_FEED):
            behind = token.end
        if token.kind not in {TokenKind.SPACE, TokenKind.LINE_END, TokenKind.COMMENT}:
            last = token.end
    return behind or last


def with_mark(text: str, mark: str, *, dialect: Dialect) -> str:
    """Block with a comment that tells why its feed was changed; at most once."""
    plain = "".join(c for c in mark if " " <= c <= "~" and c not in "();~")
    if plain in text or not plain:
        return text
    found = list(tokens(text, dialect))
    ends = [token.start for token in found if token.kind is TokenKind.LINE_END]
    at = ends[0] if ends else len(text)
    comments = [token for token in found if token.kind is TokenKind.COMMENT]
    is_open = any(text[token.start] in ";*" for token in comments)
    if dialect in {Dialect.SINUMERIK, Dialect.HEIDENHAIN}:
        return (
            f"{text[:at]} {plain}{text[at:]}"
            if is_open
            else f"{text[:at]} ; {plain}{text[at:]}"
        )
    if is_open:
        at = next(token.start for token in comments if text[token.start] == ";")
        return f"{text[:at]}({plain}) {text[at:]}"
    return f"{text[:at]} ({plain}){text[at:]}"


def split_block(
    text: str, pieces: Sequence[MovePiece], feeds: Sequence[str], form: BlockForm
) -> str:
    """Divide a block into pieces with a feed each.

    Parameters
    ----------
    text : str
        Block with its line end.
    pieces : sequence of MovePiece
        At least two.
    feeds : sequence of str
        Number of the F word of each piece; empty where it stays in force.
    form : BlockForm
    """
    found = list(tokens(text, form.dialect))
    ending = "".join(text[t.start : t.end] for t in found if t.kind is TokenKind.LINE_END)
    newline = ending or form.style.newline
    total = _relative_total(found)
    lines: list[str] = []
    spent: dict[int, Decimal] = {}
    for index, (piece, feed) in enumerate(zip(pieces, feeds, strict=True)):
        is_last = index == len(pieces) - 1
        words = _PieceWords(form, piece, total=total, spent=spent, is_last=is_last)
        words.is_first = index == 0
        if index == 0:
            line = _first(text, found, words, form)
        else:
            line = _further(text, found, words, form, is_last=is_last)
        if feed:
            line = with_feed(line, feed, dialect=form.dialect, gap=form.style.gap)
        lines.append(line + (ending if is_last else newline))
        for axis in words.moved:
            spent[axis] = spent.get(axis, Decimal(0)) + words.moved[axis]
    return "".join(lines)


def _relative_total(found: Sequence[Token]) -> dict[int, Decimal]:
    """Numbers of all axis words of a block, as they are written."""
    return {
        AXES[t.name]: Decimal(t.value)
        for t in found
        if t.kind is TokenKind.WORD and t.name in AXES
    }


class _PieceWords:
    """Coordinate words of one piece."""

    def __init__(
        self,
        form: BlockForm,
        piece: MovePiece,
        *,
        total: dict[int, Decimal],
        spent: dict[int, Decimal],
        is_last: bool,
    ) -> None:
        self.form, self.piece, self.is_last = form, piece, is_last
        self.is_first = False
        """Whether the piece starts where the block starts."""
        self._total, self._spent = total, spent
        self.moved: dict[int, Decimal] = {}
        """Distance that relative words have moved each axis."""

    def axis(self, axis: int, *, is_relative: bool, written: str) -> str:
        """Number of an axis word of the piece."""
        style = self.form.style
        if is_relative:
            left = self._total.get(axis, Decimal(0)) - self._spent.get(axis, Decimal(0))
            value = left if self.is_last else self.piece.end[axis] - self.piece.start[axis]
            self.moved[axis] = value
            return _exact(value, style)
        if written and (self.is_last or axis not in self.form.axes):
            return written
        return style.coordinate(self.piece.end[axis])

    def centre(self, axis: int, written: str) -> str:
        """Number of a word I, J or K of the piece."""
        is_kept = self.form.is_centre_absolute or axis not in self.form.arc
        if written and (is_kept or self.is_first):
            return written
        return self.form.style.coordinate(self.piece.offset[axis])

    def radius(self, written: str) -> str:
        """Number of the radius, negative above half a turn."""
        plain = written.lstrip("+-")
        sign = "+" if written.startswith("+") or self.form.style.is_signed else ""
        return f"-{plain}" if abs(self.piece.turn) > HALF else f"{sign}{plain}"


HALF = 3.141592653589793


def _exact(value: Decimal, style: NumberStyle) -> str:
    """Text of a distance with all of its decimals, so that distances add up."""
    rounded = value.quantize(Decimal(1).scaleb(-style.places))
    if rounded == value:
        return style.coordinate(rounded)
    text = f"{value.normalize():f}"
    return f"+{text}" if style.is_signed and not text.startswith("-") else text


def _first(text: str, found: Sequence[Token], words: _PieceWords, form: BlockForm) -> str:
    """First piece: the whole block with other coordinates, without late functions."""
    parts: list[str] = []
    axes_end = centres_start = centres_end = 0
    for token in found:
        if token.kind is TokenKind.LINE_END:
            continue
        if _is_late(token, form.dialect):
            if parts and not parts[-1].strip():
                parts.pop()
            continue
        if _is_motion(token, form) or (_is_geometry(token, form) and token.name in AXES):
            axes_end = len(parts) + 1
        elif _is_geometry(token, form) and not _counts_turns(token, form):
            centres_start = centres_start or len(parts)
            centres_end = len(parts) + 1
        parts.append(_replaced(text, token, words, form))
    gap = form.style.gap
    parts[centres_end:centres_end] = [
        gap + word for word in _missing_centres(found, words, form)
    ]
    axes = _missing_axes(found, words, form)
    if centres_start and axes_end < centres_start:
        parts[centres_start:centres_start] = [word + gap for word in axes]
    else:
        parts[axes_end:axes_end] = [gap + word for word in axes]
    if parts and not parts[-1].strip():
        parts.pop()
    return "".join(parts)


def _further(
    text: str, found: Sequence[Token], words: _PieceWords, form: BlockForm, *, is_last: bool
) -> str:
    """Middle or last piece: motion, coordinates, and at last the late functions."""
    skip = "".join(text[t.start : t.end] for t in found if t.kind is TokenKind.SKIP)
    heads, geometry, tails, late = [], [], [], []
    for token in found:
        piece = text[token.start : token.end]
        if _is_motion(token, form):
            heads.append(piece)
        elif token.kind is TokenKind.NAME and token.name in {"DR+", "DR-"}:
            tails.append(piece)
        elif _is_geometry(token, form):
            geometry.append(_replaced(text, token, words, form))
        elif _is_late(token, form.dialect) and is_last:
            late.append(piece)
    gap = form.style.gap
    missing = (*_missing_axes(found, words, form), *_missing_centres(found, words, form))
    geometry = [*missing, *geometry]
    body = gap.join([*heads, *_ordered(geometry), *tails, *late])
    return (f"{skip}{gap}" if skip else "") + body


def _ordered(words: Sequence[str]) -> list[str]:
    """Words with the axes before centres and radius, each in the order X, Y, Z."""
    order = ("X", "U", "IX", "Y", "IY", "Z", "W", "IZ", "I", "J", "K", "R", "CR", "P", "TU")

    def place(word: str) -> int:
        letters = word[:2].upper() if word[:2].upper() in order else word[:1].upper()
        return order.index(letters)

    return sorted(words, key=place)


def _is_motion(token: Token, form: BlockForm) -> bool:
    if form.dialect is Dialect.HEIDENHAIN:
        return token.kind is TokenKind.NAME and token.name in KLARTEXT_HEADS
    return (
        token.kind is TokenKind.WORD
        and token.name == "G"
        and float(token.value) in {1.0, 2.0, 3.0}
    )


def _is_geometry(token: Token, form: BlockForm) -> bool:
    names = {*AXES, *CENTRES, RADII.get(form.dialect, "R")}
    is_named = token.kind is TokenKind.WORD and token.name in names
    return is_named or _counts_turns(token, form)


def _counts_turns(token: Token, form: BlockForm) -> bool:
    """True if a token is the number of turns of an arc."""
    name, _ = TURNS.get(form.dialect, ("", 0))
    return bool(form.arc) and token.kind is TokenKind.WORD and token.name == name


def _is_late(token: Token, dialect: Dialect) -> bool:
    if token.kind is not TokenKind.WORD or token.name != "M":
        return False
    return round(10.0 * float(token.value)) in iso_codes.END_FUNCTIONS[dialect]


def _replaced(text: str, token: Token, words: _PieceWords, form: BlockForm) -> str:
    """Text of a token with the number of the piece, if it is a coordinate."""
    written = text[token.start : token.end]
    if not _is_geometry(token, form):
        return written
    head = written[: len(written) - len(token.value)]
    if _counts_turns(token, form):
        return f"{head}{words.piece.turns - TURNS[form.dialect][1]}"
    if token.name in AXES:
        is_relative = form.is_relative or token.name in RELATIVE
        return head + words.axis(AXES[token.name], is_relative=is_relative, written=token.value)
    if token.name in CENTRES:
        return head + words.centre(CENTRES[token.name], token.value)
    return head + words.radius(token.value)


def _missing_axes(found: Sequence[Token], words: _PieceWords, form: BlockForm) -> list[str]:
    """Words of axes that the pieces need and the block does not have."""
    given = {AXES[t.name] for t in found if t.kind is TokenKind.WORD and t.name in AXES}
    is_klartext = form.dialect is Dialect.HEIDENHAIN
    letters = ("IX", "IY", "IZ") if form.is_relative and is_klartext else ("X", "Y", "Z")
    return [
        letters[axis] + words.axis(axis, is_relative=form.is_relative, written="")
        for axis in form.axes
        if axis not in given
    ]


def _missing_centres(found: Sequence[Token], words: _PieceWords, form: BlockForm) -> list[str]:
    """Words I, J and K that the pieces need and the block does not have."""
    given = {CENTRES[t.name] for t in found if t.kind is TokenKind.WORD and t.name in CENTRES}
    if not given or form.is_centre_absolute:
        return []
    return ["IJK"[axis] + words.centre(axis, "") for axis in form.arc if axis not in given]
