"""Building of AIM instances along the reference paths, for instances of ISO 14649.

The builder walks the paths that the reader follows, and makes what it does not find. Rows that
begin alike share what they make: several dimensions of a tool stand in one representation.
"""

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass

from stepnc_model.ap238.drafting import LISTS, AimDraft
from stepnc_model.ap238.quantity import number_of
from stepnc_model.ap238.table import Condition, Ending, Kind, Move, Path, Row, Rule, Step, rules
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
    Kind.COUNT: ((), "COUNT_MEASURE", "count"),
}
"""Entities, type and unit of the measure for each kind of value."""

_GEOMETRY = ("GEOMETRIC_REPRESENTATION_ITEM",)

SCHEMA = "MODEL_BASED_INTEGRATED_MANUFACTURING_SCHEMA"
"""Schema that new files name."""


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
        self._nodes: dict[int, int] = dict(known)
        self._made: dict[tuple[int, Step, Step | None, int], int] = {}
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
        """Whether the constants of a rule are those of an instance."""
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
        self._set_all(node, node, rule.base.settings)
        for condition in rule.base.conditions:
            self._fulfil(node, condition)
        self._complete(node)
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

    def _refer(self, node: int, steps: tuple[Step, ...], value: Value, place: int) -> None:
        """Build a path to the instance that a reference leads to."""
        if not isinstance(value, Ref):
            return
        number = int(value)
        if all(step.move in (Move.STAY, Move.USED) for step in steps):
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
                self._fulfil(target, condition)
        if name:
            self._named.add(target)
        if last.move is Move.BACK:
            self._draft.put(target, last.attribute, holder)
            return
        present = self._draft.get(holder, last.attribute)
        is_taken = present is not None and (present != Ref(target) or place > 0)
        if last.attribute not in LISTS and is_taken:
            holder = self._walk(node, steps[:-1], target=(last, target), place=place, fork=True)
        self._draft.put(holder, last.attribute, target)
        if any(self._draft.is_a(target, name) for name in _GEOMETRY):
            self._set_context(holder)

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
        steps: tuple[Step, ...],
        *,
        target: tuple[Step, int] | None,
        place: int,
        fork: bool = False,
    ) -> int:
        """Go along a path and make what is missing; return the last instance."""
        owner = node
        for number, step in enumerate(steps):
            if step.move in (Move.STAY, Move.USED):
                continue
            following = steps[number + 1] if number + 1 < len(steps) else None
            is_own = place if step.move is Move.BACK and _is_repeated(steps, number) else 0
            # What refers back is shared by paths that leave it through the same attribute.
            leaving = following if following and following.move is Move.FORWARD else None
            key = node, step, leaving, is_own if not fork else -1 - place
            if key not in self._made:
                self._made[key] = self._stepped(owner, node, step, target, place)
            node = self._made[key]
        return node

    def _stepped(
        self,
        owner: int,
        node: int,
        step: Step,
        target: tuple[Step, int] | None,
        place: int,
    ) -> int:
        """Instance one step away: the one that is there, or a new one."""
        draft = self._draft
        if step.move is Move.FORWARD:
            present = draft.get(node, step.attribute)
            if isinstance(present, Ref) and step.attribute not in LISTS:
                return int(present)
            names = step.made or step.types or ("REPRESENTATION",)
            if step.attribute == "of_shape" and target is not None:
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
        self._describe(made, owner, step)
        return made

    def _describe(self, made: int, owner: int, step: Step) -> None:
        """Set what a step says about the instance that it makes."""
        self._set_all(made, owner, step.settings)
        for condition in step.conditions:
            self._fulfil(made, condition)
        self._complete(made)

    def _set_all(self, node: int, owner: int, settings: tuple[tuple[str, str], ...]) -> None:
        """Set attributes of an instance, some of them as its owner has them."""
        for name, text in settings:
            path, _, type_ = name.partition(":")
            names = tuple(path.split("."))
            if text == "*":
                described = self._draft.get(owner, "description")
                self._draft.set(node, name, described if isinstance(described, str) else "")
            elif name == "ranking":
                self._draft.set(node, name, int(text))
            else:
                texts = (text,) if text else ()
                self._fulfil(node, Condition(attributes=names, type=type_, texts=texts))

    def _complete(self, node: int) -> None:
        """Give a new instance the context that its entity requires."""
        draft = self._draft
        if draft.is_a(node, "REPRESENTATION") and draft.get(node, "context_of_items") is None:
            if draft.is_a(node, "SHAPE_REPRESENTATION"):
                self._set_context(node)
            else:
                draft.set(node, "context_of_items", Ref(self._plain_context()))
        if draft.is_a(node, "SHAPE_ASPECT") and draft.get(node, "of_shape") is None:
            if not draft.is_a(node, "INSTANCED_FEATURE"):
                draft.set(node, "of_shape", Ref(self._component_shape()))
            else:
                draft.set(node, "product_definitional", Enumeration("T"))

        if draft.is_a(node, "PRODUCT") and draft.get(node, "frame_of_reference") is None:
            context = draft.shared(
                ("PRODUCT_CONTEXT",),
                {
                    "name": "CNC Machining",
                    "frame_of_reference": Ref(self._application()),
                    "discipline_type": "manufacturing",
                },
            )
            draft.set(node, "frame_of_reference", (Ref(context),))
        if draft.is_a(node, "PRODUCT_DEFINITION"):
            context = draft.shared(
                ("PRODUCT_DEFINITION_CONTEXT",),
                {
                    "name": "CNC Machining",
                    "frame_of_reference": Ref(self._application()),
                    "life_cycle_stage": "manufacturing",
                },
            )
            draft.set(node, "frame_of_reference", Ref(context))

    def _application(self) -> int:
        """Context of the application, with the standard that defines it."""
        context = self._draft.shared(
            ("APPLICATION_CONTEXT",),
            {"application": "Application protocol for the exchange of CNC data"},
        )
        self._draft.shared(
            ("APPLICATION_PROTOCOL_DEFINITION",),
            {
                "status": "international standard",
                "application_interpreted_model_schema_name": SCHEMA.lower(),
                "application_protocol_year": 2020,
                "application": Ref(context),
            },
        )
        return context

    def _plain_context(self) -> int:
        """Context of representations without geometry."""
        return self._draft.shared(
            ("REPRESENTATION_CONTEXT",), {"context_type": "units not necessary"}
        )

    def _set_context(self, node: int) -> None:
        """Give a representation the context of geometry in mm and degrees."""
        draft = self._draft
        if not draft.is_new(node) or not draft.is_a(node, "REPRESENTATION"):
            return
        units = tuple(Ref[object](draft.unit(name)) for name in ("mm", "deg"))
        context = draft.shared(
            ("GEOMETRIC_REPRESENTATION_CONTEXT", "GLOBAL_UNIT_ASSIGNED_CONTEXT"),
            {"coordinate_space_dimension": 3, "units": units},
        )
        draft.set(node, "context_of_items", Ref(context))

    def _component_shape(self) -> int:
        """Shape that the components of features are aspects of."""
        draft = self._draft
        definition = draft.shared(
            ("FEATURE_COMPONENT_DEFINITION",), {"name": "feature component"}
        )
        return draft.shared(
            ("PRODUCT_DEFINITION_SHAPE",),
            {"name": "feature component", "definition": Ref(definition)},
        )

    def _fulfil(self, node: int, condition: Condition) -> None:
        """Make a condition true."""
        *path, last = condition.attributes
        if condition.type:
            path, last = [*path, last], ""
        if not path:
            if condition.texts:
                self._draft.set(node, last, condition.texts[0])
            return
        if not last:
            self._chain(node, path, condition.type)
            return
        if not condition.texts or path == ["items"]:
            return
        if path[0] == "formation":
            for attribute in path:
                present = self._draft.get(node, attribute)
                node = int(present) if isinstance(present, Ref) else node
            self._draft.set(node, last, condition.texts[0])
            return
        type_ = {"kind": "ACTION_RESOURCE_TYPE"}[path[0]]
        made = self._draft.shared((type_,), {last: condition.texts[0]})
        self._draft.put(node, path[0], made)

    def _chain(self, node: int, path: list[str], last: str) -> None:
        """Make a chain of instances, such as the formation and the product of a definition."""
        types = {"formation": "PRODUCT_DEFINITION_FORMATION"}
        for place, attribute in enumerate(path):
            is_last = place == len(path) - 1
            present = self._draft.get(node, attribute)
            if isinstance(present, Ref):
                node = int(present)
                continue
            made = self._draft.make((last if is_last else types[attribute],), {})
            self._complete(made)
            self._draft.put(node, attribute, made)
            node = made

    def _value(self, node: int, path: Path, value: Value) -> None:
        """Build a path to a text or a number."""
        ending = path.ending
        last = path.steps[-1] if path.steps else None
        if last is None or last.move is not Move.FORWARD:
            self._measure_on(node, ending, value)
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
            text = next(aim for aim, iso in ending.texts if iso == str(value))
            return self._draft.make(
                ("DESCRIPTIVE_REPRESENTATION_ITEM",), {"name": name, "description": text}
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
    """Whether a path can end with a value."""
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
    """Whether a list of references is an attribute of the instance itself."""
    return (
        isinstance(value, tuple)
        and len(path.steps) == 1
        and path.steps[0].move is Move.FORWARD
        and path.steps[0].attribute not in LISTS
    )


def _plain(value: Value) -> Value:
    """Value without the type that ISO 14649 may give it."""
    return value.value if isinstance(value, Typed) else value


def _name_of(step: Step) -> str:
    """Name that a step asks of its instance; empty for any."""
    named = (c.texts[0] for c in step.conditions if c.attributes == ("name",) and c.texts)
    return next(named, "")


def _mark(path: Path) -> int:
    """Number that tells paths apart that differ in the conditions of their steps only."""
    return 0 if path.ending.kind is not Kind.OWN_LENGTH else 1


def _is_repeated(steps: tuple[Step, ...], number: int) -> bool:
    """Whether each value of a list has a chain of its own, which begins at a step."""
    return number == 0 and steps[0].move is Move.BACK and _is_relation(steps[0].entity)


def _is_relation(entity: str) -> bool:
    """Whether an entity relates one instance to one other."""
    return entity.endswith(("_RELATIONSHIP", "_OPTION", "_CHARACTERIZATION", "_REFERENCE")) or (
        entity == "PRODUCT_DEFINITION_SHAPE"
    )
