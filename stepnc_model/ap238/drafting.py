"""Changes of an AP238 file: attributes by name, new instances, units.

A draft hides whether an instance is one of the file, simple or complex, or a new one. Nothing
is written before :meth:`AimDraft.apply`, so that new instances can grow.
"""

from collections import Counter
from collections.abc import Iterable, Mapping

from stepnc_model.ap238.instances import Instances, is_a, lineage, own_attributes, references
from stepnc_model.ap238.instances import attributes as all_attributes
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import DERIVED, Enumeration, Real, Ref, Typed, Value
from stepnc_model.part21.writer import Edits

_NAMING = "NAME_ATTRIBUTE"

_TEXTS = frozenset({
    "id",
    "name",
    "description",
    "consequence",
    "purpose",
    "identification",
    "source",
    "ranking_rationale",
    "measure_name",
    "attribute_value",
    "context_identifier",
    "context_type",
})
"""Attributes of texts, which are empty where nothing is to be said."""

LISTS = frozenset({
    "items",
    "usage",
    "definitions",
    "qualifiers",
    "elements",
    "units",
})
"""Attributes that hold several references."""

_Made = dict[tuple[str, str], Value]


class AimDraft:
    """Changes of one AP238 file, collected until they are applied.

    The object has state; the file itself never changes.

    Parameters
    ----------
    file : Part21File
    instances : Instances
        Instances of the file.
    """

    def __init__(self, file: Part21File, instances: Instances) -> None:
        self.edits = Edits(file)
        self._file = file
        self._instances = instances
        self._made: dict[int, tuple[tuple[str, ...], _Made]] = {}
        self._changed: dict[tuple[int, int, int], Value] = {}
        self._removed: set[int] = set()
        self._forgotten: set[int] = set()
        """Removed instances that were taken out of the edits."""
        self._shared: dict[object, int] = {}
        self._uses: Counter[int] | None = None

    def make(self, names: tuple[str, ...], values: Mapping[str, Value]) -> int:
        """Add an instance of one or, as a complex instance, of several entities."""
        if not self._made:
            self._first = self.edits.next_id()
        id = self._first + len(self._made)
        self._made[id] = names, {}
        for attribute, value in values.items():
            self.set(id, attribute, value)
        return id

    def shared(self, names: tuple[str, ...], values: Mapping[str, Value]) -> int:
        """Instance with such values: one of the file, or one made for all who need it."""
        key = names, tuple(values.items())
        if key not in self._shared:
            present = self._alike(names, values)
            self._shared[key] = self.make(names, values) if present is None else present
        return self._shared[key]

    def _alike(self, names: tuple[str, ...], values: Mapping[str, Value]) -> int | None:
        """Instance of the file with exactly such values, if there is one."""
        wanted = {owner for name in names for owner in lineage(name)}
        for id in self._instances.of_entity(names[0]):
            keywords = {keyword for keyword, _ in self._instances.parts(id)}
            entities = {owner for keyword in keywords for owner in lineage(keyword)}
            if id in self._removed or entities != wanted:
                continue
            if all(_is_value(self._instances.values(id, k), v) for k, v in values.items()):
                return id
        return None

    def is_a(self, id: int, name: str) -> bool:
        """True if an instance of the file or a new one is of an entity."""
        if id in self._made:
            return any(is_a(each, name) for each in self._made[id][0])
        return self._instances.is_a(id, name)

    def made(self) -> tuple[int, ...]:
        """New instances, in the order in which they were added."""
        return tuple(self._made)

    def drop_entity(self, id: int, name: str) -> None:
        """Let a new complex instance no longer be of an entity."""
        names, values = self._made[id]
        self._made[id] = tuple(each for each in names if each != name), values

    def is_new(self, id: int) -> bool:
        """True if an instance was added by this draft."""
        return id in self._made

    def get(self, id: int, attribute: str) -> Value:
        """Present value of an attribute; None if it is not given."""
        if id in self._made:
            found = [v for (_, name), v in self._made[id][1].items() if name == attribute]
            return next((value for value in reversed(found) if value not in (None, "")), None)
        for part, place in reversed(self._instances.slots(id, attribute)):
            if (id, part, place) in self._changed:
                return self._changed[id, part, place]
        return self._instances.value(id, attribute)

    def set(self, id: int, attribute: str, value: Value) -> None:
        """Set an attribute, in every entity of the instance that has it."""
        if id not in self._made:
            for part, place in self._instances.slots(id, attribute):
                self._changed[id, part, place] = value
            return
        names, values = self._made[id]
        owners = dict.fromkeys(
            owner
            for name in names
            for owner in lineage(name)
            if attribute in own_attributes(owner)
        )
        if not owners:
            raise ValueError(f"{' and '.join(names)} have no {attribute}")
        for owner in owners:
            values[owner, attribute] = value

    def append(self, id: int, attribute: str, target: int) -> None:
        """Add a reference to an attribute that holds several."""
        present = self.get(id, attribute)
        inner = present.value if isinstance(present, Typed) else present
        items = inner if isinstance(inner, tuple) else ()
        if attribute == "item_element":
            self.set(id, attribute, Typed("LIST_REPRESENTATION_ITEM", (*items, Ref(target))))
        elif Ref(target) not in items:
            self.set(id, attribute, (*items, Ref(target)))

    def put(self, id: int, attribute: str, target: int) -> None:
        """Let an attribute refer to an instance, as its only or as a further one."""
        if attribute in LISTS:
            self.append(id, attribute, target)
        else:
            self.set(id, attribute, Ref(target))

    def take(self, id: int, attribute: str, target: int) -> None:
        """Remove a reference from an attribute that holds several."""
        present = self.get(id, attribute)
        if isinstance(present, tuple):
            self.set(id, attribute, tuple(ref for ref in present if ref != target))

    def copy(self, id: int) -> int:
        """Add an instance like another."""
        parts = self._instances.parts(id)
        names = tuple(keyword for keyword, _ in parts)
        made = self.make(names, {})
        for keyword, given in parts:
            owners = [keyword] if len(parts) > 1 else list(lineage(keyword))
            slots = [(owner, name) for owner in owners for name in own_attributes(owner)]
            self._made[made][1].update(zip(slots, given, strict=False))
        return made

    def uses(self, id: int) -> int:
        """Number of references to an instance by instances of the file that stay.

        A name given to an instance is none.
        """
        return self._counted()[id]

    def _counted(self) -> Counter[int]:
        """Number of references to each instance."""
        if self._uses is None:
            self._uses = Counter(
                int(ref)
                for other in self._file.ids()
                if self._file.keyword(other) != _NAMING
                for _, values in self._instances.parts(other)
                for value in values
                for ref in references(value)
            )
        return self._uses

    def remove_with(self, ids: Iterable[int], anchors: frozenset[int] = frozenset()) -> None:
        """Remove instances, and with them what only they refer to.

        Parameters
        ----------
        ids : iterable of int
        anchors : frozenset of int
            Instances that stay.
        """
        waiting = [id for id in ids if id in self._file and id not in anchors]
        uses = self._counted()
        while waiting:
            id = waiting.pop()
            if id in self._removed:
                continue
            self._removed.add(id)
            self._removed.update(self._instances.referrers(id, _NAMING, "named_item"))
            for _, values in self._instances.parts(id):
                for ref in (ref for value in values for ref in references(value)):
                    uses[int(ref)] -= 1
                    if uses[int(ref)] <= 0 and int(ref) not in anchors:
                        waiting.append(int(ref))

    def unit(self, name: str) -> int:
        """Unit of a name as ISO 14649 or a record writes it.

        A name that is not known becomes a unit without dimension, such as a hardness.
        """
        simple = {
            "mm": ("LENGTH_UNIT", "MILLI", "METRE"),
            "m": ("LENGTH_UNIT", None, "METRE"),
            "um": ("LENGTH_UNIT", "MICRO", "METRE"),
            "s": ("TIME_UNIT", None, "SECOND"),
            "rad": ("PLANE_ANGLE_UNIT", None, "RADIAN"),
        }
        if name in simple:
            return self._si_unit(*simple[name])
        plain = {
            "kW": ("KILO", "WATT"),
            "N": (None, "NEWTON"),
            "J": (None, "JOULE"),
            "Pa": (None, "PASCAL"),
        }
        if name in plain:
            prefix, si_name = plain[name]
            return self.shared(
                ("SI_UNIT",),
                {
                    "dimensions": DERIVED,
                    "prefix": None if prefix is None else Enumeration(prefix),
                    "name": Enumeration(si_name),
                },
            )
        if name == "deg":
            return self._degree()
        if name == "1":
            return self.shared(("RATIO_UNIT",), {"dimensions": Ref(self._exponents())})
        powers = {
            "m/s": (("m", 1.0), ("s", -1.0)),
            "rev/s": (("s", -1.0),),
            "N/mm2": (("N", 1.0), ("mm", -2.0)),
        }
        if name in powers:
            return self._derived(name, powers[name])
        return self.shared(
            ("CONTEXT_DEPENDENT_UNIT",), {"dimensions": Ref(self._exponents()), "name": name}
        )

    def _si_unit(self, kind: str, prefix: str | None, name: str) -> int:
        """SI unit of a dimension."""
        return self.shared(
            (kind, "NAMED_UNIT", "SI_UNIT"),
            {
                "dimensions": DERIVED,
                "prefix": None if prefix is None else Enumeration(prefix),
                "name": Enumeration(name),
            },
        )

    def _degree(self) -> int:
        """Degree as a multiple of the radian."""
        factor = self.shared(
            ("PLANE_ANGLE_MEASURE_WITH_UNIT",),
            {
                "value_component": Typed("PLANE_ANGLE_MEASURE", Real(0.017453292519943295)),
                "unit_component": Ref(self._si_unit("PLANE_ANGLE_UNIT", None, "RADIAN")),
            },
        )
        return self.shared(
            ("CONVERSION_BASED_UNIT", "NAMED_UNIT", "PLANE_ANGLE_UNIT"),
            {
                "name": "degree",
                "conversion_factor": Ref(factor),
                "dimensions": Ref(self._exponents()),
            },
        )

    def _exponents(self) -> int:
        """Dimensional exponents of a number."""
        names = all_attributes("DIMENSIONAL_EXPONENTS")
        return self.shared(("DIMENSIONAL_EXPONENTS",), dict.fromkeys(names, Real(0.0)))

    def _derived(self, name: str, powers: tuple[tuple[str, float], ...]) -> int:
        """Product of powers of units, with its name."""
        elements = tuple(
            Ref[object](
                self.shared(
                    ("DERIVED_UNIT_ELEMENT",),
                    {"unit": Ref(self.unit(unit)), "exponent": Real(power)},
                )
            )
            for unit, power in powers
        )
        unit = self.shared(("DERIVED_UNIT",), {"elements": elements})
        self.shared(("NAME_ATTRIBUTE",), {"attribute_value": name, "named_item": Ref(unit)})
        return unit

    def apply(self) -> bytes:
        """Bytes of the file with all changes."""
        self.forget_removed()
        for (id, part, place), value in self._changed.items():
            if id not in self._removed:
                self.edits.replace_in_part(id, part, place, value)
        for names, values in self._made.values():
            self._write(names, values)
        return self.edits.apply()

    def forget_removed(self) -> None:
        """Take the removed instances out; to be called before the first new one is made."""
        for id in self._removed - self._forgotten:
            self.edits.remove(id)
        self._forgotten.update(self._removed)

    def _write(self, names: tuple[str, ...], values: _Made) -> None:
        """Add one new instance to the edits."""
        if len(names) == 1:
            owners = [(o, name) for o in lineage(names[0]) for name in own_attributes(o)]
            given = tuple(_given(values, owner, name) for owner, name in owners)
            self.edits.add(names[0], given)
            return
        parts = sorted({owner for name in names for owner in lineage(name)})
        self.edits.add_complex([
            (part, tuple(_given(values, part, name) for name in own_attributes(part)))
            for part in parts
        ])


def _is_value(found: tuple[Value, ...], value: Value) -> bool:
    """True if an attribute has a value, in every entity that has the attribute."""
    return bool(found) and all(each == value for each in found)


def _given(values: _Made, owner: str, name: str) -> Value:
    """Value of an attribute; an empty text or ``$`` if none was set."""
    if (owner, name) in values:
        return values[owner, name]
    if name == "product_definitional":
        return Enumeration("F")
    return "" if name in _TEXTS and owner not in ("SI_UNIT",) else None
