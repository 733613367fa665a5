"""Changes of a program of ISO 14649 brought into the AP238 file that it was read from.

A changed number is replaced where it stands; what several attributes share is split first. New
instances are built along the reference paths, and instances that are no longer part of the
program are removed together with what only they use. All other bytes stay as they are.

Parameters to which nothing refers in ISO 14649, as properties of a workplan in the AIM.

Records of an optimisation are such parameters: interpreters of programs never meet them. In the
AIM every item needs a representation: those of one workingstep get one, by their names.
"""

from collections.abc import Iterable, Mapping
from itertools import pairwise

from stepnc_model.ap238.building import Builder, aim_number
from stepnc_model.ap238.drafting import LISTS, AimDraft
from stepnc_model.ap238.instances import Instances
from stepnc_model.ap238.quantity import MEASURES, conversion, measure_kind
from stepnc_model.ap238.reading import AimReader
from stepnc_model.ap238.reference_paths import RULE, Place
from stepnc_model.ap238.table import (
    Converted,
    Ending,
    Kind,
    Path,
    PathMove,
    PathStep,
    Row,
    loose_rule,
)
from stepnc_model.ap238.view import AimView
from stepnc_model.entities.catalogue import classes
from stepnc_model.entities.conversion import AttributeSlot, slots_of
from stepnc_model.entities.geometry import RepresentationItem
from stepnc_model.errors import SchemaError
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Real, Ref, Typed, Value

_GROUP = 2
"""Number of colons in a parameter's name before that of its group: its workingstep."""


def loose_numbers(file: Part21File, numbers: Iterable[int]) -> list[int]:
    """Those of some instances that are parameters to which no instance refers."""
    wanted = [
        number
        for number in numbers
        if issubclass(classes().get(file.keyword(number), object), loose_rule().entity)
    ]
    if not wanted:
        return []
    used = {
        int(ref)
        for number in file.ids()
        for _, values in file.parts(number)
        for ref in _references(values)
    }
    return [number for number in wanted if number not in used]


def _references(value: object) -> Iterable[Ref[object]]:
    """All references in a value of ISO 14649."""
    if isinstance(value, Ref):
        return (value,)
    if isinstance(value, tuple):
        return [ref for item in value for ref in _references(item)]
    return ()


def hang(draft: AimDraft, file: Part21File, items: Mapping[int, int], owner: int) -> None:
    """Hang items on a workplan, with one property for each group of names.

    Parameters
    ----------
    draft : AimDraft
    file : Part21File
        Instances of ISO 14649.
    items : mapping of int to int
        AIM item of each parameter, by the number of the parameter.
    owner : int
        AIM instance of the workplan.
    """
    groups: dict[str, list[int]] = {}
    for number, item in items.items():
        name = str(file.parameters(number)[0])
        parts = name.split(":", _GROUP)
        groups.setdefault(parts[-1] if len(parts) > _GROUP else "", []).append(item)
    (name,) = loose_rule().base.conditions[0].texts
    context = draft.shared(("REPRESENTATION_CONTEXT",), {"context_type": "units not necessary"})
    for group, members in groups.items():
        property_ = draft.make(
            ("ACTION_PROPERTY",), {"name": name, "description": group, "definition": Ref(owner)}
        )
        representation = draft.make(
            ("REPRESENTATION",),
            {"items": tuple(map(Ref, members)), "context_of_items": Ref(context)},
        )
        draft.make(
            ("ACTION_PROPERTY_REPRESENTATION",),
            {"property": Ref(property_), "representation": Ref(representation)},
        )


def without(reader: AimReader, draft: AimDraft, gone: set[int]) -> list[int]:
    """Take items out of their properties; return the instances of those left empty.

    Parameters
    ----------
    reader : AimReader
    draft : AimDraft
    gone : set of int
        Items to be removed.
    """
    members: dict[tuple[int, ...], list[int]] = {}
    for place in reader.loose():
        members.setdefault(place.way[:-1], []).append(place.id)
    empty: list[int] = []
    for way, items in members.items():
        if gone.issuperset(items):
            empty += way[:2]
            continue
        for item in gone.intersection(items):
            draft.take(way[-1], "items", item)
    return empty


def spliced_into(
    view: AimView,
    changed: bytes,
    removed: Iterable[int] = (),
    *,
    before: Part21File | None = None,
) -> bytes:
    """Bring the changes of a view into its AP238 file; return the bytes of the new file.

    Parameters
    ----------
    view : AimView
        Program as it was read.
    changed : bytes
        The same program of ISO 14649 after changes.
    removed : iterable of int
        Instances removed from the view; a new one may have the number of a removed one.
    before : Part21File, optional
        AP238 file as it was before earlier changes: what was there without a number stays
        there without one.

    Returns
    -------
    bytes

    Raises
    ------
    SchemaError
        If AP238 cannot express a change.
    """
    new = Part21File.from_bytes(changed, name=view.name)
    splice = _Splice(view, new, set(removed), before)
    data = splice.apply()
    if splice.redirected:
        splice.require_taken(AimView.of(Part21File.from_bytes(data, name=view.name)))
    return data


class _Splice:
    """Changes of one file, applied once."""

    def __init__(
        self, view: AimView, new: Part21File, removed: set[int], before: Part21File | None
    ) -> None:
        self._view = view
        self._new = new
        self._before = None if before is None else Instances(before)
        self._reader = AimReader(view.source)
        self._draft = AimDraft(view.source, self._reader.instances)
        present = set(new.ids())
        self._gone = removed | {id for id in view.ids() if id not in present}
        kept = {
            number: each.origin
            for number, each in view.origins.items()
            if number not in self._gone
        }
        self._kept = kept
        self._builder = Builder(new, self._draft, kept)
        self.redirected: list[tuple[Converted, Row, int]] = []
        """Attributes that lead to another instance of the AP238 file, with its number."""

    def require_taken(self, view: AimView) -> None:
        """Refuse a reference that the changed file, as it is read, does not have."""
        for each, row, target in self.redirected:
            number = view.number_of(each)
            place = list(slots_of(each.rule.entity)).index(row.attribute) if each.rule else 0
            value = None if number is None else view.parameters(number)[place]
            found = view.origins.get(int(value)) if isinstance(value, Ref) else None
            if found is None or found.origin != target:
                raise self._refusal(each.number, row.attribute)

    def apply(self) -> bytes:
        """Bytes of the AP238 file with all changes."""
        self._remove()
        # First what is new, in the order in which it was added: records come last, so that
        # their numbers are the same when they are written again.
        added = sorted(set(self._new.ids()) - self._kept.keys())
        built = {number: self._builder.build(number) for number in added}
        loose = loose_numbers(self._new, added)
        items = {number: node for number in loose if (node := built[number]) is not None}
        if items:
            hang(self._draft, self._new, items, self._kept[self._new.ids_of("WORKPLAN")[0]])
        for number in self._kept:
            self._change(self._view.origins[number])
        for each in self._builder.unsayable:
            raise self._refusal(each.number, each.attribute)
        return self._draft.apply()

    def _remove(self) -> None:
        """Remove the instances that are gone, with what only they use."""
        kept = frozenset(self._kept.values())
        gone: list[int] = []
        for number in sorted(self._gone):
            each = self._view.origins.get(number)
            if each is None or each.rule is None:
                continue
            start = Place(id=each.origin, context=each.context, way=(each.origin,))
            for row in each.rule.rows:
                if row.is_derived:
                    continue
                for path in row.paths:
                    for place in self._reader.follow(start, path.steps):
                        gone += _own_part(place, path)
            if each.origin not in kept:
                gone.append(each.origin)
        gone += without(self._reader, self._draft, set(gone))
        self._draft.remove_with(gone, kept)
        self._draft.forget_removed()

    def _change(self, each: Converted) -> None:
        """Bring the changed attributes of one instance into the file."""
        if each.rule is None:
            return
        new, before = (file.parameters(each.number) for file in (self._new, self._view.read))
        if new == before:
            return
        rows = {row.attribute: row for row in each.rule.rows}
        for place, (name, slot) in enumerate(slots_of(each.rule.entity).items()):
            old = before[place]
            value = new[place] if place < len(new) else None
            if value == old:
                continue
            row = rows.get(name)
            if row is None:
                raise self._refusal(each.number, name)
            if not row.is_derived:
                self._change_attribute(each, row, slot, value)

    def _change_attribute(
        self, each: Converted, row: Row, slot: AttributeSlot, value: Value
    ) -> None:
        """Change one attribute: in place where it is given, or along its path."""
        start = Place(id=each.origin, context=each.context, way=(each.origin,))
        found = [
            (path, place)
            for path in row.paths
            for place in self._reader.follow(start, path.steps)
        ]
        if slot.items is not None and slot.items.references:
            self._change_list(each, row, found, value)
        elif isinstance(value, Ref) and found:
            self._redirect(each, row, found[0], value)
        elif found and value is not None:
            self._edit(each, row, found[0], value)
        elif found:
            for path, place in found:
                self._empty(path, place)
        elif value is not None:
            self._builder.write_row(each.number, each.origin, row, value)

    def _empty(self, path: Path, place: Place) -> None:
        """Remove what stands for an attribute, or only its number if it had none before."""
        before = self._before
        if (
            before is not None
            and place.id in before
            and before.slots(place.id, "value_component")
            and before.value(place.id, "value_component") is None
        ):
            self._draft.set(self._unshared(place.way), "value_component", None)
            return
        self._draft.remove_with(_own_part(place, path), frozenset(self._kept.values()))

    def _change_list(
        self, each: Converted, row: Row, found: list[tuple[Path, Place]], value: Value
    ) -> None:
        """Remove from a list of references what is gone, and add what is new."""
        items = value if isinstance(value, tuple) else ()
        wanted = [int(item) for item in items if isinstance(item, Ref)]
        stays = {self._kept[number] for number in wanted if number in self._kept}
        for path, place in found:
            if place.id not in stays and path.steps[-1].move is PathMove.FORWARD:
                self._draft.take(place.way[-2], path.steps[-1].attribute, place.id)
        here = {place.id for _, place in found}
        new = [number for number in wanted if self._kept.get(number) not in here]
        if new:
            refs = tuple(Ref[object](number) for number in new)
            self._builder.write_row(each.number, each.origin, row, refs)

    def _redirect(
        self, each: Converted, row: Row, found: tuple[Path, Place], value: Ref[object]
    ) -> None:
        """Let the last step of a path lead to another instance."""
        path, place = found
        target = self._builder.build(int(value))
        if target is None or not path.steps or len(place.way) < 2:
            raise self._refusal(each.number, row.attribute)
        kind = classes().get(self._new.keyword(int(value)), RepresentationItem)
        is_geometry = issubclass(kind, RepresentationItem)
        scale = self._reader.geometry_factor(place.context)
        if self._draft.is_new(target) and is_geometry and scale != 1.0:
            # New geometry is in mm, and would be read in the unit of the file's.
            raise self._refusal(each.number, row.attribute)
        self.redirected.append((each, row, target))
        last, holder = path.steps[-1], place.way[-2]
        if self._draft.is_new(target):
            self._name(target, last)
        if last.move is PathMove.BACK:
            if last.attribute in LISTS:
                self._draft.take(place.id, last.attribute, holder)
            self._draft.put(target, last.attribute, holder)
            return
        holder = self._unshared(place.way[:-1])
        present = self._draft.get(holder, last.attribute)
        self._draft.set(holder, last.attribute, _replaced(present, place.id, target))

    def _name(self, target: int, step: PathStep) -> None:
        """Give a new instance the texts by which a path finds it."""
        for condition in step.conditions:
            if len(condition.attributes) == 1 and condition.texts:
                self._draft.set(target, condition.attributes[0], condition.texts[0])

    def _edit(self, each: Converted, row: Row, found: tuple[Path, Place], value: Value) -> None:
        """Replace a text or a number where it stands."""
        path, place = found
        ending = path.ending
        if ending.kind in (Kind.TEXT, Kind.INTEGER):
            holder = self._unshared(place.way)
            self._draft.set(holder, path.steps[-1].attribute, value)
        elif ending.kind in (Kind.FLAG, Kind.CHOICE):
            text = next((aim for aim, iso in ending.texts if iso == str(value)), None)
            if text is None:
                raise self._refusal(each.number, row.attribute)
            self._draft.set(self._unshared(place.way), "description", text)
        elif ending.kind in (Kind.COORDINATES, Kind.VERBATIM) and row.attribute != "name":
            scale = self._reader.geometry_factor(place.context)
            is_length = ending.kind is Kind.COORDINATES and scale != 1.0
            written = _divided(value, scale) if is_length else value
            self._draft.set(self._unshared(place.way), path.steps[-1].attribute, written)
        elif ending.kind is Kind.LENGTHS:
            self._edit_list(each, row, path, value)
        elif ending.kind is Kind.WRITTEN:
            self._set_number(place.id, value)
        elif ending.kind in MEASURES or ending.kind in (Kind.RADIUS, Kind.LIP_ANGLE):
            holder = self._unshared(place.way)
            self._set_number(holder, self._in_file(place, ending, value))
        else:
            raise self._refusal(each.number, row.attribute)

    def _edit_list(self, each: Converted, row: Row, path: Path, value: Value) -> None:
        """Replace the numbers of a list, if there are as many as before."""
        start = Place(id=each.origin, context=each.context, way=(each.origin,))
        places = self._reader.follow(start, path.steps)
        numbers = value if isinstance(value, tuple) else (value,)
        for place in places[len(numbers) :]:
            self._draft.take(place.way[-2], path.steps[-1].attribute, place.id)
        for place, number in zip(places, numbers, strict=False):
            ending = Ending(kind=Kind.LENGTH)
            holder = self._unshared(place.way)
            self._set_number(holder, self._in_file(place, ending, number))
        if len(numbers) > len(places):
            raise self._refusal(each.number, row.attribute)

    def _set_number(self, holder: int, number: Value) -> None:
        """Replace the number of a measure; its type stays."""
        present = self._draft.get(holder, "value_component")
        keyword = present.keyword if isinstance(present, Typed) else "NUMERIC_MEASURE"
        self._draft.set(holder, "value_component", Typed(keyword, number))

    def _in_file(self, place: Place, ending: Ending, value: Value) -> Real:
        """Number in the unit of the file for a number of ISO 14649."""
        number = aim_number(ending.kind, value)
        unit = self._reader.unit_of(place)
        factor = conversion(unit, MEASURES[measure_kind(ending)]).factor
        if factor == 1.0:
            return number
        # Twelve digits, as all numbers that are written.
        return Real(float(f"{number / factor:.12g}"))

    def _unshared(self, way: tuple[int, ...]) -> int:
        """Last instance of a way, copied as far as others use the way too.

        What refers back to the way is its own; so is all before it.
        """
        draft = self._draft
        moves = [
            (before, id, self._attributes_between(before, id)) for before, id in pairwise(way)
        ]
        own = max((row for row, (*_, found) in enumerate(moves, 1) if not found), default=0)
        holder = way[own]
        for before, id, attributes in moves[own:]:
            if holder == before and draft.uses(id) < 2:
                holder = id
                continue
            copy = draft.copy(id)
            present = draft.get(holder, attributes[0])
            draft.set(holder, attributes[0], _replaced(present, id, copy))
            holder = copy
        return holder

    def _attributes_between(self, before: int, id: int) -> list[str]:
        """Attributes by which an instance refers to the next one of a way."""
        draft = self._draft
        return [name for name in _FORWARD if Ref(id) in _targets(draft.get(before, name))]

    def _refusal(self, number: int, attribute: str) -> SchemaError:
        """Error about something that AP238 cannot express."""
        line = self._view.line(number) if number in self._view else 0
        label = (self._view if number in self._view else self._new).label(number)
        return SchemaError(
            f"cannot be written into an AP238 file ({RULE})",
            entity=label,
            attribute=attribute,
            line=line,
        )


_FORWARD = (
    "representation",
    "used_representation",
    "items",
    "item_element",
    "qualifiers",
    "related_method",
    "formation",
    "of_product",
)
"""Attributes through which several instances may come to share what they lead to."""


def _divided(value: Value, scale: float) -> Value:
    """Lengths in the unit of the file's geometry; twelve digits, as all that are written."""
    if isinstance(value, tuple):
        return tuple(_divided(item, scale) for item in value)
    if not isinstance(value, int | float):
        raise TypeError(f"{value!r} is not a length")
    return Real(float(f"{value / scale:.12g}"))


def _targets(value: Value) -> tuple[Value, ...]:
    """References of an attribute."""
    if isinstance(value, Typed):
        value = value.value
    return value if isinstance(value, tuple) else (value,)


def _replaced(value: Value, old: int, new: int) -> Value:
    """Value in which a reference leads to another instance."""
    if isinstance(value, Typed):
        return Typed(value.keyword, _replaced(value.value, old, new))
    if isinstance(value, tuple):
        return tuple(_replaced(item, old, new) for item in value)
    return Ref(new) if isinstance(value, Ref) and value == old else value


def _own_part(place: Place, path: Path) -> list[int]:
    """Instances of a way that refer back to its start, directly or by others."""
    own: list[int] = []
    steps = [step for step in path.steps if step.move in (PathMove.BACK, PathMove.FORWARD)]
    for step, id in zip(steps, place.way[1:], strict=False):
        if step.move is PathMove.FORWARD or step is steps[-1]:
            break
        own.append(id)
    return own
