"""Reading of an AP238 program into instances of ISO 14649, along the reference paths.

Beginning at the project, every instance is converted by the rule for the entity that is
expected there. The number of an instance of ISO 14649 is that of the AIM instance that stands
for it; where one AIM instance stands for several (a tool, its body and its dimensions), the
others get numbers above the largest of the file. Deviations are findings; reading never fails.
"""

import re
from collections import deque
from dataclasses import dataclass, field

from stepnc_model.ap238.instances import Instances, references
from stepnc_model.ap238.numbering import AimNumbering, what
from stepnc_model.ap238.orientation import upright
from stepnc_model.ap238.quantity import (
    MEASURES,
    AimMeasure,
    Conversion,
    Unit,
    Units,
    conversion,
    measure_kind,
    number_of,
)
from stepnc_model.ap238.rational import rational_text
from stepnc_model.ap238.reference_paths import PathFollower, Place
from stepnc_model.ap238.table import (
    Converted,
    ConvertedText,
    Ending,
    Kind,
    Path,
    PathStep,
    Row,
    Rule,
    loose_rule,
    rules,
    rules_for,
)
from stepnc_model.ap238.vendor_arc import with_vendor_arcs
from stepnc_model.entities.conversion import AttributeSlot, slots_of
from stepnc_model.entities.geometry import CartesianPoint
from stepnc_model.errors import Finding, Severity
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Enumeration, Real, Ref, Typed, Value
from stepnc_model.units import MM_PER_M

_NUMBER = rb"-?\d+\.\d*(?:E[+-]?\d+)?"
_PLAIN_POINT = re.compile(
    rb"CARTESIAN_POINT(\('[ -&(-[\]-~]*',\(%b(?:,%b)*\)\));" % (_NUMBER, _NUMBER)
)
"""Point that is written as this project writes it: no spaces, no escapes in its name."""

SLOW = 0.1e-3
"""Speed in m/s below which the unit of a number is doubtful: no cutter feeds 6 mm/min."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Origin:
    """AIM instance that stands for an instance of ISO 14649."""

    id: int
    rule: Rule
    context: int | None


@dataclass(slots=True)
class AimReading:
    """Instances of ISO 14649 read from an AP238 file, and the findings on the way."""

    converted: list[ConvertedText] = field(default_factory=list)
    findings: tuple[Finding, ...] = ()


class AimReader:
    """Reader of one file.

    The object has state: the instances met so far, and those still to be converted.

    Parameters
    ----------
    file : Part21File
    """

    def __init__(self, file: Part21File) -> None:
        self.instances = Instances(file)
        self.units = Units(self.instances)
        self._paths = PathFollower(self.instances)
        self._file = file
        self._numbers = AimNumbering(max(file.ids(), default=0) + 1)
        self._waiting: deque[tuple[int, Origin]] = deque()
        self._reading = AimReading()
        self._visited: set[int] = set()
        """Properties and items of tool bodies on the ways to all values read."""
        self._without_rule: dict[tuple[str, str], list[int]] = {}
        """Instances that no rule describes, by what they are and where they stand."""
        self._watched = self._to_watch()
        # Rules are few and stay for good: their identity is quicker than their hash.
        self._by_rule: dict[int, list[tuple[Row | None, AttributeSlot]]] = {}
        self._factors: dict[int | None, float] = {}
        self._scaled: dict[int, bool] = {}

    def read(self) -> AimReading:
        """Convert all programs of the file."""
        for rule in rules():
            if rule.is_root:
                for name in rule.base.types[:1]:
                    for id in self.instances.of_entity(name):
                        # The first rule that describes an instance is the closest one.
                        if id not in self._numbers and self._paths.matches(id, rule):
                            self._number(Place(id=id), rule)
        for place in self.loose():
            self._visit(place)
            self._reference(place, AttributeSlot(references=(loose_rule().entity,)), "items")
        while self._waiting:
            number, origin = self._waiting.popleft()
            self._convert(number, origin)
        converted = self._reading.converted
        converted = upright(converted, self._paths, first=self._numbers.next)
        self._reading.converted, read = with_vendor_arcs(
            converted, self.instances, self._paths, self.geometry_factor
        )
        self._visited |= read
        self._tell_unknown()
        self._note_unread()
        self._reading.findings = self._paths.findings.all()
        return self._reading

    def follow(self, start: Place, steps: tuple[PathStep, ...]) -> list[Place]:
        """Places that a path leads to from an instance."""
        return self._paths.follow(start, steps)

    def loose(self) -> list[Place]:
        """Items that nothing refers to in ISO 14649."""
        rule = loose_rule()
        return [
            place
            for id in self.instances.of_entity(rule.base.types[0])
            if self._paths.matches(id, rule)
            for place in self._paths.follow(Place(id=id, way=(id,)), rule.proof)
        ]

    def _to_watch(self) -> frozenset[int]:
        """Instances of which it matters whether they are read."""
        watched = {id for name, _ in _PROPERTIES for id in self.instances.of_entity(name)}
        for body in self.instances.of_entity("MACHINING_TOOL_BODY_REPRESENTATION"):
            values = self.instances.values(body, "items")
            watched |= {body, *(int(ref) for value in values for ref in references(value))}
        return frozenset(watched)

    def _visit(self, place: Place) -> None:
        """Note that the instances on a way are read."""
        self._visited.update(id for id in place.way if id in self._watched)

    def _note_unread(self) -> None:
        """Note the properties of converted instances that no path has led to."""
        known = self._numbers
        for entity, owner in _PROPERTIES:
            for id in self.instances.of_entity(entity):
                ref = self.instances.value(id, owner)
                if isinstance(ref, Ref) and int(ref) in known and id not in self._visited:
                    self._note(id, f"the property {self._named(id)!r}", owner)
        for body in self.instances.of_entity("MACHINING_TOOL_BODY_REPRESENTATION"):
            for value in self.instances.values(body, "items"):
                for item in references(value):
                    if body in self._visited and int(item) not in self._visited:
                        self._note(
                            int(item), f"the dimension {self._named(int(item))!r}", "name"
                        )

    def _named(self, id: int) -> str:
        """Name of an instance, as far as it has one."""
        return str(self.instances.value(id, "name") or "")

    def _note(self, id: int, what: str, attribute: str) -> None:
        """Note something that ISO 14649 cannot say, or that is not read here."""
        message = f"{what} is left out: no attribute of ISO 14649 has a path to it"
        self._paths.remark(Severity.NOTE, message, id, attribute)

    def _number(self, place: Place, rule: Rule) -> Ref[object]:
        """Number of the instance that a place stands for; it is converted once."""
        is_scaled = self._scaled.get(id(rule))
        if is_scaled is None:
            is_scaled = self._scaled[id(rule)] = _is_scaled(rule)
        scale = self.geometry_factor(place.context) if is_scaled else 1.0
        kind = what(rule.entity.keyword, scale)
        number = self._numbers.known(place.id, kind)
        if number is None:
            number = self._numbers.new(place.id, kind)
            origin = Origin(id=place.id, rule=rule, context=place.context)
            self._waiting.append((number, origin))
        return Ref(number)

    def _convert(self, number: int, origin: Origin) -> None:
        """Convert one instance by its rule."""
        instance = Converted(
            number=number,
            keyword=origin.rule.entity.keyword,
            origin=origin.id,
            rule=origin.rule,
            context=origin.context,
        )
        if origin.rule.entity is CartesianPoint and (text := self._as_it_is(origin)):
            self._reading.converted.append(ConvertedText(instance=instance, text=text))
            return
        start = Place(id=origin.id, context=origin.context, way=(origin.id,))
        parameters = tuple([
            _empty(slot) if row is None else self._parameter(start, row, slot)
            for row, slot in self._columns(origin.rule)
        ])
        weights = self.instances.weights(origin.id)
        rational = rational_text(instance, parameters, weights) if weights else None
        self._reading.converted.append(rational or ConvertedText.of(instance, parameters))

    def _as_it_is(self, origin: Origin) -> bytes:
        """Parameters of a point in mm as the file has them; empty where they are converted.

        Most instances of a program of tool paths are points: none of these is parsed here.
        """
        if self._file.keyword(origin.id) != "CARTESIAN_POINT":
            return b""
        if self.geometry_factor(origin.context) != 1.0:
            return b""
        found = _PLAIN_POINT.search(self._file.data, *self._file.span(origin.id))
        return found[1] if found else b""

    def _columns(self, rule: Rule) -> list[tuple[Row | None, AttributeSlot]]:
        """Slot of each attribute of an entity, with its row if it has one."""
        if id(rule) not in self._by_rule:
            rows = {row.attribute: row for row in rule.rows}
            self._by_rule[id(rule)] = [
                (rows.get(name), slot) for name, slot in slots_of(rule.entity).items()
            ]
        return self._by_rule[id(rule)]

    def _parameter(self, start: Place, row: Row, slot: AttributeSlot) -> Value:
        """Value of one attribute, by the first of its paths that gives one."""
        for path in row.paths:
            if path.ending.kind is Kind.VERBATIM:
                return self._verbatim(start, row.attribute, slot)
            found = self._along(start, path, slot, row.attribute)
            if row.is_derived:
                found = list(dict.fromkeys(found))
            if slot.items is not None and found:
                return _listed(found)
            if found:
                return found[0]
        if row.default:
            is_number = row.default.isdecimal()
            return int(row.default) if is_number else Enumeration(row.default)
        return _empty(slot)

    def _along(
        self, start: Place, path: Path, slot: AttributeSlot, attribute: str
    ) -> list[Value]:
        """Values that a path leads to."""
        places = self._paths.follow(start, path.steps)
        for place in places:
            self._visit(place)
        if path.ending.kind is Kind.REFERENCE:
            inner = slot.items or slot
            found = (self._reference(place, inner, attribute) for place in places)
            return [ref for ref in found if ref is not None]
        values = (self._value(start, place, path.ending, attribute) for place in places)
        return [value for value in values if value is not None]

    def _reference(
        self, place: Place, slot: AttributeSlot, attribute: str
    ) -> Ref[object] | None:
        """Reference to the entity that a place stands for."""
        if place.value is not None:
            return None
        for wanted in slot.references:
            for rule in rules_for(wanted):
                if self._paths.matches(place.id, rule):
                    return self._number(place, rule)
        return self._unknown(place, attribute)

    def _unknown(self, place: Place, attribute: str) -> Ref[object] | None:
        """Reference to an instance that no rule describes, kept under a name of its own."""
        kind = what("", 1.0)
        if place.id not in self._numbers:
            keyword = self._file.keyword(place.id) or "COMPLEX_INSTANCE"
            self._numbers.new(place.id, kind)
            instance = Converted(
                number=place.id, keyword=f"AIM_{keyword}", origin=place.id, rule=None
            )
            self._reading.converted.append(ConvertedText.of(instance, ()))
            described = self.instances.value(place.id, "description")
            name = f" '{described}'" if isinstance(described, str) else ""
            self._without_rule.setdefault((f"{keyword}{name}", attribute), []).append(place.id)
        number = self._numbers.known(place.id, kind)
        return None if number is None else Ref(number)

    def _tell_unknown(self) -> None:
        """Warn of instances that no rule describes, once for each kind."""
        for (kind, attribute), ids in self._without_rule.items():
            count = f" ({len(ids)} instances)" if len(ids) > 1 else ""
            text = f"{kind}{count} has no counterpart in ISO 14649 that is supported here"
            self._paths.remark(Severity.WARNING, text, ids[0], attribute)

    def _value(self, start: Place, place: Place, ending: Ending, attribute: str) -> Value:
        """Value of ISO 14649 for a place; None if it has none."""
        kind = ending.kind
        if kind in (Kind.FLAG, Kind.CHOICE, Kind.TEXT_ITEM):
            return self._described(place, ending, attribute)
        if kind is Kind.TEXT:
            return place.value if isinstance(place.value, str) else None
        if kind is Kind.INTEGER:
            number = number_of(place.value)
            return None if number is None else int(number)
        if kind is Kind.CONSTANT:
            return Enumeration(ending.keyword)
        if kind is Kind.TEXTS:
            return self._text_of(place)
        if kind is Kind.UNIT:
            return self._unit_name(place)
        if kind is Kind.COORDINATES:
            return _scaled(place.value, self.geometry_factor(place.context))
        return self._measured(start, place, ending, attribute)

    def _verbatim(self, start: Place, attribute: str, slot: AttributeSlot) -> Value:
        """Value that both standards write alike; a required text may be empty."""
        value = self.instances.value(start.id, attribute)
        if value is None and str in slot.plain:
            return ""
        return self._with_references(value, start, slot.items or slot, attribute)

    def _with_references(
        self, value: Value, start: Place, slot: AttributeSlot, attribute: str
    ) -> Value:
        """Value whose references lead to converted instances."""
        if isinstance(value, tuple):
            items = (self._with_references(item, start, slot, attribute) for item in value)
            return tuple(items)
        if isinstance(value, Ref):
            place = Place(id=int(value), context=start.context)
            return self._reference(place, slot, attribute)
        return value

    def _described(self, place: Place, ending: Ending, attribute: str) -> Value:
        """Value that the text of a descriptive item stands for."""
        text = self._text_of(place)
        if text is None or ending.kind is Kind.TEXT_ITEM:
            return text
        for aim, iso in ending.texts:
            if aim == text.strip().casefold():
                return Enumeration(iso)
        known = ", ".join(f"'{aim}'" for aim, _ in ending.texts)
        self._paths.remark(
            Severity.WARNING,
            f"'{text}' is none of {known} ({attribute})",
            place.id,
            "description",
        )
        return None

    def _text_of(self, place: Place) -> str | None:
        """Text of a descriptive item."""
        value = self.instances.value(place.id, "description")
        return value if isinstance(value, str) else None

    def _unit_name(self, place: Place) -> str:
        """Name of a measure's unit as ISO 14649 writes it."""
        ref = self.instances.value(place.id, "unit_component")
        if not isinstance(ref, Ref):
            return ""
        unit, name = self.units.unit(int(ref)), self.units.name(int(ref))
        if name in _WRITTEN_NAMES:
            return _WRITTEN_NAMES[name]
        if unit is not None:
            for kind in (Kind.LENGTH, Kind.ANGLE):
                if unit.exponents == MEASURES[kind].exponents:
                    return MEASURES[kind].unit
        return name

    def _measured(self, start: Place, place: Place, ending: Ending, attribute: str) -> Value:
        """Number in the unit of ISO 14649."""
        kind = measure_kind(ending)
        number, unit = self._number_and_unit(start, place, ending.kind)
        if number is None:
            return None
        if ending.kind is Kind.WRITTEN:
            if unit is None or self._unit_name(place) not in (_MM, _DEGREE):
                return _real(number, 1.0)
            kind = Kind.ANGLE if "angle" in unit.exponents else kind
        measure = MEASURES[kind]
        found = conversion(unit, measure)
        if not found.is_fitting:
            self._remark_unit(place.id, measure, found, attribute)
        if kind is Kind.COUNT:
            return int(number) if float(number).is_integer() else _real(number, 1.0)
        value = _real(number, found.factor)
        if kind is Kind.SPEED and 0.0 < abs(value) < SLOW:
            message = (
                f"{value * MM_PER_M:g} mm/s ({attribute}) is very slow; "
                "the number would be usual in m/s"
            )
            self._paths.remark(Severity.WARNING, message, place.id, "value_component")
        if ending.kind is Kind.RADIUS:
            value = Real(0.5 * value)
        if ending.kind is Kind.LIP_ANGLE:
            value = Real(0.5 * (180.0 - value))
        if ending.kind is Kind.TYPED:
            return Typed(ending.keyword, value)
        return Typed("SPEED_PROFILE", value) if ending.kind is Kind.PROFILE else value

    def _number_and_unit(
        self, start: Place, place: Place, kind: Kind
    ) -> tuple[float | None, Unit | None]:
        """Number of a measure with its unit, or a plain number with that of its owner."""
        if kind is Kind.OWN_LENGTH:
            return number_of(place.value), self.unit_of(start)
        number = number_of(self.instances.value(place.id, "value_component"))
        return number, self.unit_of(place)

    def unit_of(self, place: Place) -> Unit | None:
        """Unit of a measure; that of the geometry if it names none."""
        ref = self.instances.value(place.id, "unit_component")
        if isinstance(ref, Ref):
            return self.units.unit(int(ref))
        return None

    def geometry_factor(self, context: int | None) -> float:
        """Factor from the lengths of a context to mm."""
        if context not in self._factors:
            unit = self.units.length_in(context)
            self._factors[context] = conversion(unit, MEASURES[Kind.LENGTH]).factor
        return self._factors[context]

    def _remark_unit(
        self, id: int, measure: AimMeasure, found: Conversion, attribute: str
    ) -> None:
        """Note a unit that does not fit its value."""
        ref = self.instances.value(id, "unit_component")
        name = self.units.name(int(ref)) if isinstance(ref, Ref) else ""
        message = (
            f"the unit{f' {name!r}' if name else ''} does not measure {measure.noun} "
            f"({attribute}); one is taken for {found.factor:g} {measure.unit}"
        )
        self._paths.remark(Severity.WARNING, message, id, "unit_component")


_PROPERTIES = (
    ("ACTION_PROPERTY", "definition"),
    ("RESOURCE_PROPERTY", "resource"),
    ("PROPERTY_DEFINITION", "definition"),
)
"""Entities of properties, with the attribute that refers to their owner."""

_MM = MEASURES[Kind.LENGTH].unit
_DEGREE = MEASURES[Kind.ANGLE].unit
_WRITTEN_NAMES = {
    "kilowatt": "kW",
    "newton": "N",
    "joule": "J",
    "second": "s",
    "micrometre": "um",
    "micrometer": "um",
    "pascal": "Pa",
}
"""Names of units in the files of ISO 14649; their numbers are not converted."""


def _is_scaled(rule: Rule) -> bool:
    """True if a rule is about geometry, whose numbers depend on a context."""
    return any(
        path.ending.kind in (Kind.COORDINATES, Kind.VERBATIM)
        for row in rule.rows
        for path in row.paths
    )


def _listed(found: list[Value]) -> tuple[Value, ...]:
    """List of the values found; a value that is a list already stands for itself."""
    if len(found) == 1 and isinstance(found[0], tuple):
        return found[0]
    return tuple(found)


def _empty(slot: AttributeSlot) -> Value:
    """Value of an attribute that a file does not give."""
    return () if slot.items is not None and not slot.is_optional else None


def _real(number: float, factor: float) -> Real:
    """Number in another unit; with its own digits if the unit is the same."""
    if factor == 1.0:
        return number if isinstance(number, Real) else Real(number)
    return Real(number * factor)


def _scaled(value: Value, factor: float) -> Value:
    """Lengths of geometry in mm."""
    if isinstance(value, tuple):
        return tuple(_scaled(item, factor) for item in value)
    number = number_of(value)
    return None if number is None else _real(number, factor)
