"""Reference paths between the entities of ISO 14649 and the AIM, read from ``paths.txt``.

The table is the only place that knows how AP238 expresses an attribute. The reader follows its
paths, the writer builds instances along them.

Instance of ISO 14649 with the AIM instance that stands for it.

References
----------
.. [1] ISO 10303-238, 5.1 (mapping table).
"""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cache
from importlib.resources import files

from stepnc_model.ap238.instances import attributes
from stepnc_model.entities.catalogue import classes
from stepnc_model.entities.conversion import slots_of
from stepnc_model.entities.entity import Entity
from stepnc_model.part21.tokens import tidy_values
from stepnc_model.part21.values import Value
from stepnc_model.part21.writer import format_value


class PathMove(StrEnum):
    """Direction of one step of a reference path."""

    FORWARD = "."
    """To what an attribute holds."""
    BACK = "<"
    """To the instances whose attribute refers here."""
    STAY = ":"
    """Nowhere: the step only checks the type of the instance."""
    USED = "?"
    """Nowhere: the step checks that some instance refers here."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PathCondition:
    """Condition that an attribute holds one of some texts, or anything."""

    attributes: tuple[str, ...]
    """Attributes to follow, one after another."""
    type: str = ""
    """Entity at the end of the attributes; empty if only the text counts."""
    texts: tuple[str, ...] = ()
    """Allowed texts; none: any value."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PathStep:
    """Step of a reference path with its conditions."""

    move: PathMove
    entity: str = ""
    """Entity of the step; empty for any."""
    attribute: str = ""
    conditions: tuple[PathCondition, ...] = ()
    types: tuple[str, ...] = ()
    """Entities that the instance must be."""
    order: str = ""
    """Attribute by which instances are sorted; empty for file order."""
    made: tuple[str, ...] = ()
    """Entities of the instance that a writer makes here."""
    settings: tuple[tuple[str, str], ...] = ()
    """Attributes that a writer sets, with their texts."""


class Kind(StrEnum):
    """Kind of value at the end of a path."""

    REFERENCE = "reference"
    TEXT = "text"
    TEXT_ITEM = "text item"
    TEXTS = "texts"
    FLAG = "flag"
    CHOICE = "choice"
    INTEGER = "integer"
    CONSTANT = "constant"
    VERBATIM = "verbatim"
    COORDINATES = "coordinates"
    COUNT = "count"
    LENGTH = "length"
    RADIUS = "radius"
    """Half of a diameter that the AIM gives."""
    OWN_LENGTH = "own length"
    """Plain number in the unit of the instance that the rule stands for."""
    LENGTHS = "lengths"
    ANGLE = "angle"
    LIP_ANGLE = "lip angle"
    """Angle between lip and face plane; the AIM gives the included point angle."""
    RATIO = "ratio"
    TIME = "time"
    SPEED = "speed"
    ROTATION = "rotation"
    PRESSURE = "pressure"
    ROUGHNESS = "roughness"
    """Height of a surface texture, in µm."""
    PROFILE = "profile"
    """Ratio of a speed profile, a typed value of ISO 14649."""
    TYPED = "typed"
    WRITTEN = "written"
    """Number as it is written, in a unit that another attribute names."""
    UNIT = "unit"


@dataclass(frozen=True, slots=True, kw_only=True)
class Ending:
    """Value at the end of a path."""

    kind: Kind
    texts: tuple[tuple[str, str], ...] = ()
    """Texts of the AIM with the values of ISO 14649 that they stand for."""
    keyword: str = ""
    """Type of a typed value of ISO 14649."""
    measure: Kind = Kind.LENGTH
    """Measure within a typed value."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Path:
    """Reference path with the value at its end."""

    steps: tuple[PathStep, ...]
    ending: Ending


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """Reference paths of one attribute; the first that leads somewhere counts."""

    attribute: str
    paths: tuple[Path, ...]
    default: str = ""
    """Value where the mapping may be omitted; empty for none."""
    is_derived: bool = False
    """Whether the value follows from others and is never written."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Rule:
    """AIM instance that stands for an entity, and the paths of its attributes."""

    entity: type[Entity]
    base: PathStep
    """Entity and conditions of the instance."""
    proof: tuple[PathStep, ...] = ()
    """Path that must lead somewhere."""
    rows: tuple[Row, ...] = ()
    is_root: bool = False
    """Whether every such instance is read, even if nothing refers to it."""
    is_loose: bool = False
    """Whether the proof leads to instances that nothing refers to in ISO 14649."""


@cache
def _all_rules() -> tuple[Rule, ...]:
    """All rules, in the order of the table."""
    text = files("stepnc_model.ap238").joinpath("paths.txt").read_text("ascii")
    return tuple(_TableParser(text).rules())


@cache
def rules() -> tuple[Rule, ...]:
    """Rules of instances that stand for entities, in the order of the table."""
    return tuple(rule for rule in _all_rules() if not rule.is_loose)


@cache
def loose_rule() -> Rule:
    """Rule of the parameters to which nothing refers in ISO 14649."""
    return next(rule for rule in _all_rules() if rule.is_loose)


@cache
def rules_for(wanted: type[Entity]) -> tuple[Rule, ...]:
    """Rules of an entity class and its subclasses, in the order of the table."""
    return tuple(rule for rule in rules() if issubclass(rule.entity, wanted))


_STEP = re.compile(
    r"\s*(?:(?P<move>[<?])(?P<entity>[A-Z0-9_]+)\.(?P<back>[a-z0-9_]+)|\.(?P<forward>[a-z0-9_]+)"
    r"|:(?P<type>[A-Z0-9_]+)|\[(?P<condition>[^\]]*)\]|\{(?P<made>[^}]*)\}|\^(?P<order>[a-z_]+))"
)
_CALL = re.compile(r"\b([a-z_]+)\(([^()]*)\)")
_RULE = re.compile(r"(root |loose )?([A-Z0-9_]+) = ([A-Z0-9_&]+)(.*)")
_ROW = re.compile(r"  ([a-z0-9_]+) (~?=) ?(.*)")
_MACRO = re.compile(r"macro ([a-z_]+)\(([^()]*)\) = (.*)")


@dataclass(slots=True)
class _Draft:
    """Rule while its rows are collected."""

    entity: type[Entity]
    base: PathStep
    proof: tuple[PathStep, ...]
    is_root: bool
    is_loose: bool
    rows: dict[str, Row] = field(default_factory=dict)

    def finished(self) -> Rule:
        """Rule with the rows that its entity has, in the order of its attributes."""
        rows = tuple(self.rows[name] for name in slots_of(self.entity) if name in self.rows)
        return Rule(
            entity=self.entity,
            base=self.base,
            proof=self.proof,
            rows=rows,
            is_root=self.is_root,
            is_loose=self.is_loose,
        )


class _TableParser:
    """Parser of the table; a mistake in it is a ``ValueError`` with the line."""

    def __init__(self, text: str) -> None:
        self._lines = text.splitlines()
        self._macros: dict[str, tuple[tuple[str, ...], str]] = {}
        self._groups: dict[str, dict[str, Row]] = {}

    def rules(self) -> Iterator[Rule]:
        """Rules of the table."""
        draft: _Draft | None = None
        group: dict[str, Row] | None = None
        for line in self._lines:
            if not line or line.startswith("#"):
                continue
            row = _ROW.fullmatch(line)
            if row is not None:
                rows = draft.rows if draft is not None else group
                if rows is None:
                    raise ValueError(f"a row without a rule: {line!r}")
                rows[row[1]] = self._row(row)
                continue
            if draft is not None:
                yield draft.finished()
            draft, group = None, None
            if line.startswith("macro "):
                self._add_macro(line)
            elif line.startswith("group "):
                group = self._groups.setdefault(line.removeprefix("group "), {})
            elif line.startswith("same "):
                yield _same(line.removeprefix("same ").split())
            else:
                draft = self._draft(line)
        if draft is not None:
            yield draft.finished()

    def _add_macro(self, line: str) -> None:
        match = _MACRO.fullmatch(line)
        if match is None:
            raise ValueError(f"not a macro: {line!r}")
        names = tuple(name.strip() for name in match[2].split(";") if name.strip())
        self._macros[match[1]] = (names, match[3])

    def _draft(self, line: str) -> _Draft:
        match = _RULE.fullmatch(line)
        if match is None:
            raise ValueError(f"not a rule: {line!r}")
        body, _, groups = match[4].partition(" < ")
        base, *proof = self._steps(f":{match[3].partition('&')[0]}{body}")
        made = tuple(match[3].split("&"))
        rows = {}
        for name in filter(None, (name.strip() for name in groups.split(","))):
            rows.update(self._groups[name])
        return _Draft(
            entity=classes()[match[2]],
            base=PathStep(
                move=PathMove.STAY,
                types=made,
                conditions=base.conditions,
                made=base.made or made,
                settings=base.settings,
            ),
            proof=tuple(proof),
            is_root=match[1] == "root ",
            is_loose=match[1] == "loose ",
            rows=rows,
        )

    def _row(self, match: re.Match[str]) -> Row:
        text, _, default = match[3].partition(" else ")
        paths = tuple(self._path(part) for part in self._expanded(text).split(" | "))
        return Row(
            attribute=match[1],
            paths=paths,
            default=default.strip(),
            is_derived=match[2] == "~=",
        )

    def _expanded(self, text: str) -> str:
        """Text with its macros replaced; what follows ``->`` has none."""
        parts = []
        for part in text.split(" | "):
            path, arrow, ending = part.partition("->")
            while (call := _CALL.search(path)) is not None:
                path = path[: call.start()] + self._called(call) + path[call.end() :]
            parts.append(f"{path}{arrow}{ending}")
        return " | ".join(parts)

    def _called(self, call: re.Match[str]) -> str:
        """Text of a macro with its arguments in place."""
        names, text = self._macros[call[1]]
        arguments = [argument.strip() for argument in call[2].split(";")] if names else []
        if len(names) != len(arguments):
            raise ValueError(f"{call[0]!r} needs {len(names)} arguments")
        given = dict(zip(names, arguments, strict=True))
        words = re.compile(
            r"(?<![A-Za-z_*])(" + "|".join(map(re.escape, given)) + r")(?![A-Za-z_])"
        )
        return words.sub(lambda word: given[word[1]], text) if given else text

    def _path(self, text: str) -> Path:
        steps, arrow, ending = text.partition("->")
        return Path(
            steps=self._steps(steps),
            ending=_ending(ending.strip()) if arrow else Ending(kind=Kind.REFERENCE),
        )

    def _steps(self, text: str) -> tuple[PathStep, ...]:
        """Steps of a path; types, conditions and settings belong to the step before them."""
        expanded, place, steps = self._expanded(text).strip(), 0, list[_StepDraft]()
        while place < len(expanded):
            match = _STEP.match(expanded, place)
            if match is None:
                raise ValueError(f"not a path: {expanded[place:]!r}")
            place = match.end()
            _add_step(steps, match)
        return tuple(step.finished() for step in steps)


@dataclass(slots=True)
class _StepDraft:
    """Step while its modifiers are collected."""

    move: PathMove
    entity: str = ""
    attribute: str = ""
    conditions: list[PathCondition] = field(default_factory=list)
    types: list[str] = field(default_factory=list)
    order: str = ""
    made: tuple[str, ...] = ()
    settings: list[tuple[str, str]] = field(default_factory=list)

    def finished(self) -> PathStep:
        """Step with all its modifiers."""
        return PathStep(
            move=self.move,
            entity=self.entity,
            attribute=self.attribute,
            conditions=tuple(self.conditions),
            types=tuple(self.types),
            order=self.order,
            made=self.made,
            settings=tuple(self.settings),
        )


def _add_step(steps: list[_StepDraft], match: re.Match[str]) -> None:
    """Add a step, or a modifier to the last one."""
    kind = match.lastgroup
    if kind == "back":
        steps.append(
            _StepDraft(PathMove(match["move"]), entity=match["entity"], attribute=match["back"])
        )
        return
    if kind == "forward":
        steps.append(_StepDraft(PathMove.FORWARD, attribute=match["forward"]))
        return
    if not steps:
        steps.append(_StepDraft(PathMove.STAY))
    step = steps[-1]
    if kind == "type":
        step.types.append(match["type"])
    elif kind == "condition":
        step.conditions.append(_condition(match["condition"]))
    elif kind == "order":
        step.order = match["order"]
    else:
        _add_settings(step, match["made"])


def _condition(text: str) -> PathCondition:
    """Condition from ``a.b=text|text``, ``a.b:ENTITY`` or ``a``."""
    path, equals, texts = text.partition("=")
    names, _, type_ = path.partition(":")
    return PathCondition(
        attributes=tuple(names.split(".")),
        type=type_,
        texts=tuple(texts.split("|")) if equals else (),
    )


def _add_settings(step: _StepDraft, text: str) -> None:
    """Add what a writer makes, ``ENTITY&ENTITY attr=text,attr=text``."""
    first, _, rest = text.partition(" ")
    if first.isupper():
        step.made, text = tuple(first.split("&")), rest
    for setting in filter(None, text.split(",")):
        name, _, value = setting.partition("=")
        step.settings.append((name.strip(), value))


_ARGUMENTS = re.compile(r"([a-z ]+?)(?:\((.*)\))?")


def _ending(text: str) -> Ending:
    """Ending from ``kind`` or ``kind(arguments)``."""
    match = _ARGUMENTS.fullmatch(text)
    if match is None:
        raise ValueError(f"not a kind of value: {text!r}")
    kind = Kind(match[1])
    words = [word.strip() for word in (match[2] or "").split(",")]
    if kind is Kind.FLAG:
        return Ending(kind=kind, texts=((words[0], "T"), (words[1], "F")))
    if kind is Kind.CHOICE:
        pairs = (word.partition("=") for word in words)
        return Ending(kind=kind, texts=tuple((aim, iso) for aim, _, iso in pairs))
    if kind is Kind.TYPED:
        return Ending(kind=kind, keyword=words[0], measure=Kind(words[1]))
    return Ending(kind=kind, keyword=words[0])


def _same(words: list[str]) -> Rule:
    """Rule of an entity that both standards share; some attributes are lengths."""
    name, *lengths = words
    entity = classes()[name]
    slots = slots_of(entity)
    known = set(attributes(name))
    rows = []
    for attribute, slot in slots.items():
        if attribute not in known:
            raise ValueError(f"{name} has no {attribute} in the AIM")
        inner = slot.items or slot
        kind = Kind.VERBATIM
        if attribute in lengths:
            kind = Kind.COORDINATES
        elif inner.references and not inner.plain:
            kind = Kind.REFERENCE
        step = PathStep(move=PathMove.FORWARD, attribute=attribute)
        rows.append(
            Row(attribute=attribute, paths=(Path(steps=(step,), ending=Ending(kind=kind)),))
        )
    base = PathStep(move=PathMove.STAY, types=(name,), made=(name,))
    return Rule(entity=entity, base=base, rows=tuple(rows))


@dataclass(frozen=True, slots=True, kw_only=True)
class Converted:
    """Instance of ISO 14649 with the AIM instance that stands for it."""

    number: int
    keyword: str
    origin: int
    rule: Rule | None
    context: int | None = None
    """Representation context that gives the units of its geometry."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ConvertedText:
    """Converted instance as it is written: its text takes a fraction of its values' memory."""

    instance: Converted
    text: bytes
    """Parameters, ``(...)``."""

    @classmethod
    def of(cls, instance: Converted, parameters: tuple[Value, ...]) -> "ConvertedText":
        """Instance with its parameters."""
        return cls(instance=instance, text=format_value(parameters))

    @property
    def line(self) -> bytes:
        """Line of a file."""
        keyword = self.instance.keyword.encode("ascii")
        return b"#%d=%s%s;" % (self.instance.number, keyword, self.text)

    @property
    def values(self) -> Mapping[str, Value]:
        """Values of the parameters by the names of their attributes."""
        rule = self.instance.rule
        if rule is None:
            return {}
        names = slots_of(rule.entity)
        return dict(zip(names, tidy_values(self.text.decode("latin-1")), strict=False))
