"""Building of AIM instances along the reference paths, for instances of ISO 14649.

The builder walks the paths that the reader follows, and makes what it does not find. Rows that
begin alike share what they make: several dimensions of a tool stand in one representation.
"""

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass

from stepnc_model.ap238.drafting import LISTS, AimDraft
from stepnc_model.ap238.quantity import number_of
from stepnc_model.ap238.requirements import Requirements
from stepnc_model.ap238.table import (
    Ending,
    Kind,
    Path,
    PathMove,
    PathStep,
    Row,
    Rule,
    rules,
)
from stepnc_model.entities.catalogue import class_of
from stepnc_model.entities.conversion import AttributeSlot, slots_of
from stepnc_model.entities.entity import Entity
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Enumeration, Real, Ref, Typed, Value


@dataclass(frozen=True, slots=True, kw_only=True)
class Unsayable:
    """Attribute or instance of ISO 14649 that AP238 cannot express by the table."""

    number: int
    """Instance of ISO 14649."""
    attribute: str
    """Attribute, or empty for the whole instance."""


_MEASURES: Mapping[Kind, tuple[tuple[str, ...], str, str]] = {
    Kind.LENGTH: (("LENGTH_MEASURE_WITH_UNIT",), "LENGTH_MEASURE", "mm"),
    Kind.RADIUS: (("LENGTH_MEASURE_WITH_UNIT",), "LENGTH_MEASURE", "mm"),
    Kind.ANGLE: (("PLANE_ANGLE_MEASURE_WITH_UNIT",), "PLANE_ANGLE_MEASURE", "deg"),
    Kind.LIP_ANGLE: (("PLANE_ANGLE_MEASURE_WITH_UNIT",), "PLANE_ANGLE_MEASURE", "deg"),
    Kind.RATIO: (("RATIO_MEASURE_WITH_UNIT",), "RATIO_MEASURE", "1"),
    Kind.PROFILE: (("RATIO_MEASURE_WITH_UNIT",), "RATIO_MEASURE", "1"),
    Kind.TIME: (("TIME_MEASURE_WITH_UNIT",), "TIME_MEASURE", "s"),
    Kind.SPEED: ((), "NUMERIC_MEASURE", "m/s"),
    Kind.ROTATION: ((), "NUMERIC_MEASURE", "rev/s"),
    Kind.PRESSURE: ((), "NUMERIC_MEASURE", "Pa"),
    Kind.ROUGHNESS: (("LENGTH_MEASURE_WITH_UNIT",), "LENGTH_MEASURE", "um"),
    Kind.COUNT: ((), "COUNT_MEASURE", "count"),
}
"""Entities, type and unit of the measure for each kind of value."""

_GEOMETRY = ("GEOMETRIC_REPRESENTATION_ITEM",)


class Builder:
    """Builder of the AIM instances for the instances of one ISO 14649 file.

    The object has state: instances built so far, and what could not be said.

    Parameters
    ----------
    file : Part21File
        Instances of ISO 14649.
    draft : AimDraft
        AP238 file to which they are added.
    known : mapping of int to int
        AIM instance of each instance that stands in the AP238 file already.
    """

    def __init__(self, file: Part21File, draft: AimDraft, known: Mapping[int, int]) -> None:
        self._file = file
        self._draft = draft
        self._asked = Requirements(draft)
        self._nodes: dict[int, int] = dict(known)
        self._made: dict[tuple[int, PathStep, PathStep | None, int], int] = {}
        self._onto_nodes: set[tuple[int, int]] = set()
        self._named: set[int] = set()
        """Instances whose name a path asks for."""
        self.unsayable: list[Unsayable] = []
        self._waiting: deque[tuple[int, int, Rule]] = deque()

    @property
    def built(self) -> Mapping[int, int]:
        """AIM instances by the instances of ISO 14649 that they stand for."""
        return self._nodes

    def build(self, number: int) -> int | None:
        """AIM instance for an instance of ISO 14649, with all that it refers to."""
        node = self._node(number)
        while self._waiting:
            waiting, base, rule = self._waiting.popleft()
            self._fill(waiting, base, rule)
        return node

    def write_row(self, number: int, node: int, row: Row, value: Value) -> None:
        """Build one attribute of an instance that stands in the file already."""
        slot = slots_of(self._class(number))[row.attribute]
        self._row(number, node, row, slot, value)
        while self._waiting:
            waiting, base, rule = self._waiting.popleft()
            self._fill(waiting, base, rule)

    def _class(self, number: int) -> type[Entity]:
        """Entity class of an instance."""
        values = self._file.parameters(number)
        found = class_of(self._file.keyword(number), len(values))
        if found is None:
            raise ValueError(f"#{number} is no entity of ISO 14649")
        return found

    def _rule(self, number: int) -> Rule | None:
        """Rule for an instance of ISO 14649."""
        if number not in self._file:
            return None
        values = self._file.parameters(number)
        wanted = class_of(self._file.keyword(number), len(values))
        found = [rule for rule in rules() if rule.entity is wanted]
        return next((rule for rule in found if self._is_agreeing(rule, values)), None)

    def _is_agreeing(self, rule: Rule, values: tuple[Value, ...]) -> bool:
        """True if the constants of a rule are those of an instance."""
        places = {name: place for place, name in enumerate(slots_of(rule.entity))}
        constants = (
            (places[row.attribute], path.ending.keyword)
            for row in rule.rows
            for path in row.paths
            if path.ending.kind is Kind.CONSTANT
        )
        return all(
            place < len(values) and str(values[place]) == text for place, text in constants
        )

    def _node(self, number: int) -> int | None:
        """AIM instance for an instance, made if need be; its attributes follow later."""
        if number in self._nodes:
            return self._nodes[number]
        rule = self._rule(number)
        if rule is None:
            self.unsayable.append(Unsayable(number=number, attribute=""))
            return None
        node = self._draft.make(rule.base.made, {})
        self._nodes[number] = node
        self._begin(number, node, rule)
        return node

    def _begin(self, number: int, node: int, rule: Rule) -> None:
        """Give an instance what its rule asks of it; the rows follow later."""
        self._asked.set_all(node, node, rule.base.settings)
        for condition in rule.base.conditions:
            self._asked.fulfil(node, condition)
        self._asked.complete(node)
        self._waiting.append((number, node, rule))

    def _fill(self, number: int, node: int, rule: Rule) -> None:
        """Build the attributes of an instance."""
        values = self._file.parameters(number)
        rows = {row.attribute: row for row in rule.rows}
        for place, (name, slot) in enumerate(slots_of(rule.entity).items()):
            value = values[place] if place < len(values) else None
            if value is None or value == ():
                continue
            if name in rows:
                self._row(number, node, rows[name], slot, value)
            else:
                self.unsayable.append(Unsayable(number=number, attribute=name))

    def _row(self, number: int, node: int, row: Row, slot: AttributeSlot, value: Value) -> None:
        """Build one attribute along the first path that can hold its value."""
        if row.is_derived:
            return
        path = next((path for path in row.paths if _is_able(path.ending, value, slot)), None)
        if path is None:
            self.unsayable.append(Unsayable(number=number, attribute=row.attribute))
            return
        kind = path.ending.kind
        if kind in (Kind.WRITTEN, Kind.UNIT):
            self._parameter(node, kind, value)
        elif kind is Kind.CONSTANT:
            return
        elif kind is Kind.VERBATIM or kind is Kind.COORDINATES:
            if row.attribute == "name" and node in self._named:
                return
            self._draft.set(node, row.attribute, self._translated(value))
        elif kind is Kind.REFERENCE and _is_plain_list(path, value):
            self._draft.set(node, path.steps[0].attribute, self._translated(value))
        elif isinstance(value, tuple) and kind is Kind.REFERENCE:
            for place, item in enumerate(value):
                self._refer(node, path.steps, item, place)
        elif kind is Kind.REFERENCE:
            self._refer(node, path.steps, value, 0)
        else:
            self._value(node, path, value)

    def _translated(self, value: Value) -> Value:
        """Value with references to AIM instances."""
        if isinstance(value, tuple):
            return tuple(self._translated(item) for item in value)
        if isinstance(value, Ref):
            node = self._node(int(value))
            return None if node is None else Ref(node)
        return value

    def _refer(self, node: int, steps: tuple[PathStep, ...], value: Value, place: int) -> None:
        """Build a path to the instance that a reference leads to."""
        if not isinstance(value, Ref):
            return
        number = int(value)
        if all(step.move in (PathMove.STAY, PathMove.USED) for step in steps):
            self._onto(node, number)
            return
        target = self._node(number)
        if target is None:
            return
        last = steps[-1]
        holder = self._walk(node, steps[:-1], target=(last, target), place=place)
        name = _name_of(last)
        if name and self._draft.is_new(target):
            present = self._draft.get(target, "name")
            if isinstance(present, str) and present != name:
                target = self._twin(number, target)
        for condition in last.conditions:
            if self._draft.is_new(target):
                self._asked.fulfil(target, condition)
        if name:
            self._named.add(target)
        if last.move is PathMove.BACK:
            self._draft.put(target, last.attribute, holder)
            return
        present = self._draft.get(holder, last.attribute)
        is_taken = present is not None and (present != Ref(target) or place > 0)
        if last.attribute not in LISTS and is_taken:
            holder = self._walk(node, steps[:-1], target=(last, target), place=place, fork=True)
        self._draft.put(holder, last.attribute, target)
        if any(self._draft.is_a(target, name) for name in _GEOMETRY):
            self._asked.set_context(holder)

    def _twin(self, number: int, target: int) -> int:
        """Second AIM instance for a measure that is used under two names."""
        del self._nodes[number]
        made = self._node(number)
        self._nodes[number] = target
        return target if made is None else made

    def _onto(self, node: int, number: int) -> None:
        """Let an AIM instance stand for a further instance of ISO 14649."""
        if (number, node) in self._onto_nodes or self._nodes.get(number) == node:
            return
        rule = self._rule(number)
        if rule is None:
            self.unsayable.append(Unsayable(number=number, attribute=""))
            return
        # Several measures may share one tolerance: each of them gets its limits.
        self._onto_nodes.add((number, node))
        self._nodes.setdefault(number, node)
        self._begin(number, node, rule)

    def _walk(
        self,
        node: int,
        steps: tuple[PathStep, ...],
        *,
        target: tuple[PathStep, int] | None,
        place: int,
        fork: bool = False,
    ) -> int:
        """Go along a path and make what is missing; return the last instance."""
        owner, begin = node, _last_relation(steps) if fork else len(steps)
        for number, step in enumerate(steps):
            if step.move in (PathMove.STAY, PathMove.USED):
                continue
            following = steps[number + 1] if number + 1 < len(steps) else None
            is_own = place if step.move is PathMove.BACK and _is_repeated(steps, number) else 0
            # What refers back is shared by paths that leave it through the same attribute.
            leaving = following if following and following.move is PathMove.FORWARD else None
            key = node, step, leaving, is_own if number < begin else -1 - place
            if key not in self._made:
                self._made[key] = self._stepped(owner, node, step, target, place)
            node = self._made[key]
        return node

    def _stepped(
        self,
        owner: int,
        node: int,
        step: PathStep,
        target: tuple[PathStep, int] | None,
        place: int,
    ) -> int:
        """Instance one step away: the one that is there, or a new one."""
        draft = self._draft
        if step.move is PathMove.FORWARD:
            present = draft.get(node, step.attribute)
            is_shape = step.attribute == "of_shape" and target is not None
            is_given = isinstance(present, Ref) and step.attribute not in LISTS
            if isinstance(present, Ref) and is_given and not (is_shape and draft.is_new(node)):
                return int(present)
            names = step.made or step.types or ("REPRESENTATION",)
            if is_shape and target is not None:
                # All features of a workpiece are aspects of one shape.
                made = draft.shared(names, {target[0].attribute: Ref(target[1])})
                draft.put(node, step.attribute, made)
                return made
            made = draft.make(names, {})
            draft.put(node, step.attribute, made)
        else:
            made = draft.make(step.made or (step.entity,), {})
            draft.put(made, step.attribute, node)
            if step.order:
                draft.set(made, step.order, Real(float(place + 1)))
        self._asked.describe(made, owner, step)
        return made

    def _value(self, node: int, path: Path, value: Value) -> None:
        """Build a path to a text or a number."""
        ending = path.ending
        last = path.steps[-1] if path.steps else None
        if ending.kind is Kind.CHOICE and last is None:
            self._draft.set(node, "description", _choice(ending, value))
            return
        if last is None or last.move is not PathMove.FORWARD:
            self._measure_on(node, ending, value)
            return
        if last.made and ending.kind in _MEASURES:
            # An item that other attributes describe too.
            holder = self._walk(node, path.steps, target=None, place=0)
            self._measure_on(holder, ending, value)
            return
        if ending.kind in (Kind.TEXT, Kind.OWN_LENGTH, Kind.INTEGER):
            holder = self._walk(node, path.steps[:-1], target=None, place=_mark(path))
            if last.attribute == "name" and holder in self._named:
                return
            self._draft.set(holder, last.attribute, _plain(value))
            return
        holder = self._walk(node, path.steps[:-1], target=None, place=0)
        if ending.kind in (Kind.TEXTS, Kind.LENGTHS):
            items = value if isinstance(value, tuple) else (value,)
            inner = Ending(kind=Kind.LENGTH if ending.kind is Kind.LENGTHS else Kind.TEXT_ITEM)
            for item in items:
                self._draft.append(holder, last.attribute, self._item(inner, item, ""))
            return
        present = self._draft.get(holder, last.attribute)
        if last.attribute not in LISTS and present is not None:
            holder = self._walk(node, path.steps[:-1], target=None, place=0, fork=True)
        name = _name_of(last)
        self._draft.put(holder, last.attribute, self._item(ending, value, name))

    def _item(self, ending: Ending, value: Value, name: str) -> int:
        """Representation item with a text or a number."""
        if ending.kind in (Kind.FLAG, Kind.CHOICE):
            return self._draft.make(
                ("DESCRIPTIVE_REPRESENTATION_ITEM",),
                {"name": name, "description": _choice(ending, value)},
            )
        if ending.kind is Kind.TEXT_ITEM:
            return self._draft.make(
                ("DESCRIPTIVE_REPRESENTATION_ITEM",), {"name": name, "description": value}
            )
        kind = ending.measure if ending.kind is Kind.TYPED else ending.kind
        names, _, _ = _MEASURES[kind]
        item = self._draft.make((*names, "MEASURE_REPRESENTATION_ITEM"), {"name": name})
        self._measure_on(item, ending, value)
        return item

    def _measure_on(self, item: int, ending: Ending, value: Value) -> None:
        """Give a measure its number and unit."""
        kind = ending.measure if ending.kind is Kind.TYPED else ending.kind
        _, type_, unit_name = _MEASURES[kind]
        number = aim_number(ending.kind, value)
        unit = self._draft.unit(unit_name)
        self._draft.set(item, "value_component", Typed(type_, number))
        self._draft.set(item, "unit_component", Ref(unit))

    def _parameter(self, node: int, kind: Kind, value: Value) -> None:
        """Give a numeric parameter its number or its unit."""
        if kind is Kind.WRITTEN:
            self._draft.set(node, "value_component", Typed("NUMERIC_MEASURE", value))
            return
        name = str(value)
        known = {"MM": "mm", "": "1", "degree": "deg", "degrees": "deg"}
        unit = self._draft.unit(known.get(name, name))
        self._draft.set(node, "unit_component", Ref(unit))


def aim_number(kind: Kind, value: Value) -> Real:
    """Number of the AIM for one of ISO 14649, in the same unit."""
    number = number_of(value)
    if number is None:
        raise ValueError(f"{value!r} is not a number")
    if kind is Kind.RADIUS:
        return Real(2.0 * number)
    if kind is Kind.LIP_ANGLE:
        return Real(180.0 - 2.0 * number)
    return number if isinstance(number, Real) else Real(number)


def _is_able(ending: Ending, value: Value, slot: AttributeSlot) -> bool:
    """True if a path can end with a value."""
    if ending.kind in (Kind.FLAG, Kind.CHOICE):
        return isinstance(value, Enumeration) and str(value) in {iso for _, iso in ending.texts}
    if ending.kind is Kind.TYPED:
        return isinstance(value, Typed) and value.keyword == ending.keyword
    if ending.kind is Kind.REFERENCE:
        return isinstance(value, Ref | tuple)
    if ending.kind in _MEASURES or ending.kind is Kind.OWN_LENGTH:
        return number_of(value) is not None
    return slot.items is None or isinstance(value, tuple)


def _is_plain_list(path: Path, value: Value) -> bool:
    """True if a list of references is an attribute of the instance itself."""
    return (
        isinstance(value, tuple)
        and len(path.steps) == 1
        and path.steps[0].move is PathMove.FORWARD
        and path.steps[0].attribute not in LISTS
    )


def _choice(ending: Ending, value: Value) -> str:
    """Text of the AIM for a value of an enumeration."""
    return next(aim for aim, iso in ending.texts if iso == str(value))


def _plain(value: Value) -> Value:
    """Value without the type that ISO 14649 may give it."""
    return value.value if isinstance(value, Typed) else value


def _name_of(step: PathStep) -> str:
    """Name that a step asks of its instance; empty for any."""
    named = (c.texts[0] for c in step.conditions if c.attributes == ("name",) and c.texts)
    return next(named, "")


def _mark(path: Path) -> int:
    """Number that tells paths apart that differ in the conditions of their steps only."""
    return 0 if path.ending.kind is not Kind.OWN_LENGTH else 1


def _is_repeated(steps: tuple[PathStep, ...], number: int) -> bool:
    """True if each value of a list has a chain of its own, which begins at a step."""
    return number == 0 and steps[0].move is PathMove.BACK and _is_relation(steps[0].entity)


def _last_relation(steps: tuple[PathStep, ...]) -> int:
    """Place of the last relation of a path, from which on a further value has its own chain."""
    relations = (
        number
        for number, step in enumerate(steps)
        if step.move is PathMove.BACK and _is_relation(step.entity)
    )
    return max(relations, default=0)


def _is_relation(entity: str) -> bool:
    """True if an entity relates one instance to one other."""
    return entity.endswith(("_RELATIONSHIP", "_OPTION", "_CHARACTERIZATION", "_REFERENCE")) or (
        entity == "PRODUCT_DEFINITION_SHAPE"
    )
