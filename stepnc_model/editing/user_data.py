"""Data that a file lacks, given by the user: a depth, a number of teeth, a feed.

They are set into the text that is read, so that paths, loads and advice follow from them, and
can be withdrawn afterwards: what was given then stands nowhere in the file, and what was
advised on its basis does. Units are those of the file; in AP238 those of the number that is
replaced.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeGuard

from stepnc_model.ap238.table import Converted
from stepnc_model.ap238.view import AimView
from stepnc_model.editing.draft import Draft
from stepnc_model.entities.conversion import AttributeSlot, slots_of
from stepnc_model.entities.entity import Entity
from stepnc_model.entities.geometry import Plane
from stepnc_model.entities.measures import TolerancedLengthMeasure
from stepnc_model.entities.technology import MillingTechnology
from stepnc_model.entities.tools import MillingCuttingTool
from stepnc_model.entities.turning import TurningTechnology
from stepnc_model.errors import Part21Error, SchemaError, Severity
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Real, Ref, Value
from stepnc_model.programs.binding import Model
from stepnc_model.programs.path_technology import fed_paths
from stepnc_model.programs.program import Program, ResolvedWorkingstep
from stepnc_model.programs.tool import tool_of
from stepnc_model.units import FeedUnit, m_s_from_speed, mm_min_from_speed

_PLACE = re.compile(r"\s*#(\d{1,18})\s*\.\s*(\w+)\s*=(.*)", re.DOTALL)


@dataclass(frozen=True, slots=True, kw_only=True)
class GivenFeed:
    """Feed that a user gives, by time, by tooth or by turn."""

    value: float
    """Feed in mm/s, or in mm per tooth or revolution."""
    unit: FeedUnit
    """Unit in which it was given; the first two are both mm/s here."""

    @property
    def is_speed(self) -> bool:
        """True if it is a feed by time."""
        return self.unit in {FeedUnit.METRES_PER_SECOND, FeedUnit.MM_PER_MINUTE}


@dataclass(frozen=True, slots=True, kw_only=True)
class GivenData:
    """Data for a file that lacks them, in the words of the user."""

    values: tuple[str, ...] = ()
    """Attributes of instances, ``#46.depth=12``."""
    teeth: tuple[str, ...] = ()
    """Numbers of teeth by the id of the tool, ``T3=2``."""
    feed: GivenFeed | None = None
    """Feed of technologies that give none."""

    def __bool__(self) -> bool:
        return bool(self.values or self.teeth or self.feed is not None)


@dataclass(frozen=True, slots=True, kw_only=True)
class SetAttribute:
    """Attribute that was set, with what stood there before."""

    ref: Ref[object]
    attribute: str
    before: Value
    value: Value
    added: tuple[int, ...] = ()
    """Instances that were added for it."""
    origin: Converted | None = None
    """What stands for ``ref`` in an AP238 file, where its own number is not kept."""
    before_origin: Converted | None = None
    """What stands there for the instance that was referred to before."""
    value_origin: Converted | None = None
    """What stands there for an instance of the file that is referred to now."""
    withdrawn_with: str = ""
    """Attribute of ``ref`` that must be withdrawn too; empty: this one stands alone."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Completed:
    """Program with the data that were given."""

    program: Program
    attributes: tuple[SetAttribute, ...]


def completed(program: Program, data: GivenData) -> Completed:
    """Set data into a program.

    Returns
    -------
    Completed
        The program, read again from its changed text, and what was set.

    Raises
    ------
    SchemaError
        If an instance, an attribute, a tool or a value is not valid.
    """
    if not data:
        return Completed(program=program, attributes=())
    draft = Draft(program)
    given = [_set(draft, text) for text in data.values]
    given += [each for text in data.teeth for each in _teeth(draft, text)]
    found = _changed(draft, given)
    if data.feed is not None:
        # Numbers of teeth that were given count, too.
        draft = Draft(found)
        feeds = list(_feeds(draft, data.feed))
        found = _changed(draft, feeds)
        given += feeds
    return Completed(program=found, attributes=tuple(given))


def _changed(draft: Draft, changes: Sequence[SetAttribute]) -> Program:
    """Program read again with what was set; refused if an attribute cannot hold its value."""
    if not changes:
        return draft.program
    found = _read(draft.program, draft.edits.apply(), changes)
    for each in changes:
        _require_taken(found.model, each)
    return found


def _read(program: Program, data: bytes, changes: Sequence[SetAttribute]) -> Program:
    """Program with changed text; one of AP238 stays one."""
    file = Part21File.from_bytes(data, name=program.name)
    if isinstance(program.file, AimView):
        view = program.file
        settled = {(view.label(int(each.ref)), each.attribute) for each in changes}
        file = view.changed(file, settled)
    return program.changed(file)


def _set(draft: Draft, text: str) -> SetAttribute:
    """Set one attribute from text like ``#46.depth=12``."""
    program, found = draft.program, _PLACE.fullmatch(text)
    if found is None:
        raise SchemaError(f"'{text}': expected #INSTANCE.attribute=value")
    attribute, written = found[2], found[3].strip()
    number = _numbered(program, int(found[1]), attribute)
    ref: Ref[object] = Ref(number)
    entity = program.model.get(ref)
    slots = slots_of(type(entity))  # type: ignore[arg-type]
    if attribute not in slots:
        known = ", ".join(slots)
        text = f"has no attribute '{attribute}' that --set could set; known: {known}"
        raise program.error(text, Ref(number))
    value, slot = _value(written, text), slots[attribute]
    present = getattr(entity, attribute)
    if isinstance(present, Ref) and _is_number(value):
        inside = _in_place(draft, present, attribute, value)
        if inside is not None:
            return inside
    if _is_number(value) and float in slot.plain:
        value = _from_file(program, number, attribute, value)
    value, added = _fitting(draft, slot, value, attribute)
    return _put(draft, ref, attribute, value, added)


def _height(attribute: str, number: float) -> float:
    """Height of the plane that a number means: a depth is that of one below."""
    return -float(number) if attribute == "depth" else float(number)


def _in_place(
    draft: Draft, present: Ref[Any], attribute: str, number: float
) -> SetAttribute | None:
    """Set the number of a length or a plane where it stands; None if others use it too."""
    program = draft.program
    try:
        with program.using(present):
            if isinstance(program.get(present), TolerancedLengthMeasure):
                chain: tuple[Ref[Any], ...] = (present,)
            else:
                chain = _level_plane(program, present)
    except SchemaError:
        return None
    if not chain or any(draft.uses(each) > 1 for each in chain):
        return None
    if len(chain) == 1:
        size = _from_file(program, int(present), "theoretical_size", number)
        return _put(draft, present, "theoretical_size", size)
    x, y, _ = program.get(chain[-1]).coordinates
    height = _from_file(program, int(chain[-1]), "coordinates", _height(attribute, number))
    moved = (Real(x), Real(y), height)
    return _put(draft, chain[-1], "coordinates", moved)


def _from_file(program: Program, number: int, attribute: str, value: float) -> Real:
    """Number of ISO 14649 for one in the unit that a file of AP238 gives there."""
    factor = None
    if isinstance(program.file, AimView):
        factor = program.file.factor(number, attribute)
    return Real(value if factor is None else value * factor)


def _level_plane(program: Program, ref: Ref[Any]) -> tuple[Ref[Any], ...]:
    """Plane, placement and point of a plane across z; empty for another surface."""
    plane = program.get(ref)
    if not isinstance(plane, Plane):
        return ()
    place = program.get(plane.position)
    axis = (0.0, 0.0, 1.0) if place.axis is None else program.get(place.axis).direction_ratios
    point = program.get(place.location).coordinates
    is_level = len(axis) == 3 and axis[0] == axis[1] == 0.0 and len(point) == 3
    return (ref, plane.position, place.location) if is_level else ()


def _put(
    draft: Draft, ref: Ref[object], attribute: str, value: Value, added: tuple[int, ...] = ()
) -> SetAttribute:
    """Set an attribute and remember what stood there."""
    values = draft.program.file.parameters(int(ref))
    place = draft.program.model.position(ref, attribute)
    before = values[place] if place < len(values) else None
    draft.put(ref, attribute, value)
    return SetAttribute(
        ref=ref,
        attribute=attribute,
        before=before,
        value=value,
        added=added,
        origin=origin_in(draft.program, ref),
        before_origin=origin_in(draft.program, before),
        value_origin=origin_in(draft.program, value),
    )


def origin_in(program: Program, value: Value) -> Converted | None:
    """Origin of an instance in an AP238 file."""
    if not isinstance(value, Ref) or not isinstance(program.file, AimView):
        return None
    return program.file.origins.get(int(value))


def _value(written: str, text: str) -> Value:
    """Value of a parameter as Part 21 writes it."""
    lines = ("ISO-10303-21;", "HEADER;", "ENDSEC;", "DATA;", f"#1=X({written});", "ENDSEC;")
    data = "\n".join((*lines, "END-ISO-10303-21;")).encode()
    try:
        file = Part21File.from_bytes(data)
        values = file.parameters(1) if 1 in file else ()
    except Part21Error:
        values = ()
    if len(values) != 1 or len(file.ids()) != 1:
        raise SchemaError(f"'{text}': '{written}' is not a value of Part 21")
    return values[0]


def _numbered(program: Program, number: int, attribute: str) -> int:
    """Number of the instance with an attribute, of those that have the same one in AP238."""
    file = program.file
    if not isinstance(file, AimView) or number not in file.origins:
        return number
    origin = file.origins[number].origin
    alike = [
        each.number
        for each in file.origins.values()
        if each.origin == origin
        and each.rule is not None
        and attribute in slots_of(each.rule.entity)
    ]
    return alike[0] if len(alike) == 1 else number


def _is_number(value: Value) -> TypeGuard[int | float]:
    """True if a value is a number; references are whole numbers in Python, too."""
    return isinstance(value, int | float) and not isinstance(value, Ref)


def _fitting(
    draft: Draft, slot: AttributeSlot, value: Value, attribute: str
) -> tuple[Value, tuple[int, ...]]:
    """Value for a slot, with instances added where a number stands for a length or a plane."""
    is_count = int in slot.plain and float not in slot.plain
    if is_count or not _is_number(value):
        return value, ()
    number = float(value)
    if slot.plain or not slot.references:
        return Real(number), ()
    if TolerancedLengthMeasure in slot.references:
        added = draft.edits.add("TOLERANCED_LENGTH_MEASURE", (Real(number), None))
        return added, (int(added),)
    if any("SURFACE" in each.keyword or each.keyword == "PLANE" for each in slot.references):
        point = draft.edits.add(
            "CARTESIAN_POINT", ("", (Real(0.0), Real(0.0), Real(_height(attribute, number))))
        )
        place = draft.edits.add("AXIS2_PLACEMENT_3D", ("", point, None, None))
        plane = draft.edits.add("PLANE", ("", place))
        return plane, (int(point), int(place), int(plane))
    return Real(number), ()


def _teeth(draft: Draft, text: str) -> Iterator[SetAttribute]:
    """Set the number of teeth of a tool from text like ``T3=2``."""
    program = draft.program
    name, _, count = text.rpartition("=")
    if not name or not count.strip().isdecimal():
        raise SchemaError(f"'{text}': expected TOOL=NUMBER of teeth")
    bodies = {
        int(tool.its_tool_body)
        for _, tool in program.model.of_type(MillingCuttingTool)
        if tool.its_id == name.strip() and tool.its_tool_body is not None
    }
    if not bodies:
        known = ", ".join(f"'{t.its_id}'" for _, t in program.model.of_type(MillingCuttingTool))
        raise SchemaError(f"no tool '{name.strip()}'; known: {known or 'none'}")
    for body in sorted(bodies):
        yield _put(draft, Ref(body), "number_of_teeth", int(count))


def _feeds(draft: Draft, feed: GivenFeed) -> Iterator[SetAttribute]:
    """Set the feed of technologies that give none."""
    program = draft.program
    users: dict[Ref[Entity], list[ResolvedWorkingstep]] = {}
    for step in program.workingsteps:
        for ref in fed_technologies(program, step):
            users.setdefault(ref, []).append(step)
    for ref, steps in users.items():
        technology = program.get(ref)
        if not isinstance(technology, (MillingTechnology, TurningTechnology)):
            continue
        is_turning = isinstance(technology, TurningTechnology)
        per_edge = "feed_per_revolution" if is_turning else "feedrate_per_tooth"
        if technology.feedrate or getattr(technology, per_edge):
            continue
        if feed.is_speed or feed.unit is program.units_of(ref).feed:
            yield _put(draft, ref, "feedrate", Real(_in_file(program, ref, feed)))
            continue
        is_divided = not is_turning and feed.unit is FeedUnit.MM_PER_REVOLUTION
        edges = _teeth_of(program, ref, steps) if is_divided else 1
        if technology.feedrate is not None:
            yield replace(_put(draft, ref, "feedrate", None), withdrawn_with=per_edge)
        yield _put(draft, ref, per_edge, Real(feed.value / edges))


def fed_technologies(program: Program, step: ResolvedWorkingstep) -> list[Ref[Entity]]:
    """Technologies that give feeds of a workingstep, also those of its tool paths."""
    own = [technology for technology, _ in fed_paths(program.model, step.operation)]
    return list(dict.fromkeys([step.technology_ref, *own]))


def _in_file(program: Program, ref: Ref[Entity], feed: GivenFeed) -> float:
    """Given feed in the unit of a technology."""
    unit = program.units_of(ref).feed
    if unit is FeedUnit.METRES_PER_SECOND:
        return m_s_from_speed(feed.value)
    if unit is FeedUnit.MM_PER_MINUTE:
        return mm_min_from_speed(feed.value)
    if feed.is_speed:
        text = (
            f"the file's feeds are in {unit.value}: give this one so, as --feed 0.1{unit.value}"
        )
        raise program.error(text, ref, "feedrate")
    return feed.value


def _teeth_of(program: Program, ref: Ref[Entity], steps: Sequence[ResolvedWorkingstep]) -> int:
    """Number of teeth of the tools that use a technology."""
    tools = [tool_of(program, step.tool_ref) for step in steps]
    lacking = next((tool for tool in tools if not tool.has_teeth), None)
    if lacking is not None:
        text = f"tool '{lacking.id}' has no number of teeth"
        raise program.error(f'{text}: give it with --teeth "{lacking.id}=N"', ref, "feedrate")
    counts = {tool.teeth for tool in tools}
    if len(counts) > 1:
        text = f"its tools have {' or '.join(map(str, sorted(counts)))} teeth"
        raise program.error(
            f"{text}: give a feed per tooth, as --feed 0.1mm/tooth", ref, "feedrate"
        )
    return counts.pop()


def _require_taken(model: Model, change: SetAttribute) -> None:
    """Refuse a value that the attribute cannot hold."""
    for finding in model.findings():
        label = model.file.label(int(change.ref))
        is_here = finding.entity == label and finding.attribute == change.attribute
        if is_here and finding.severity is Severity.ERROR:
            raise SchemaError(finding.message, entity=label, attribute=change.attribute)
