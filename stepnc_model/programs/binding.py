"""Conversion between Part 21 instances and entities, driven by the entities' fields.

Reading is tolerant: deviations from the schema are findings; only requesting an instance that
does not exist or that no entity describes is an error. Entities are bound one by one on request
and hold references, so the cost depends on what is used and not on the size of the file.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import chain, islice
from typing import Any, TypeVar, cast

from stepnc_model.entities.catalogue import BY_ARITY, class_of, classes, flattened
from stepnc_model.entities.conversion import (
    AttributeSlot,
    ConversionRemark,
    give,
    slots_of,
    take,
    take_missing,
)
from stepnc_model.entities.entity import Entity, attributes
from stepnc_model.entities.operations import MachiningOperation
from stepnc_model.entities.paper002 import PRINTED, ConsistentRecord, read_printed
from stepnc_model.errors import (
    MOST_FINDINGS,
    Finding,
    FindingList,
    Part21Error,
    SchemaError,
    Severity,
)
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Derived, Ref, Typed, Value


def circles(edges: Mapping[int, tuple[int, ...]]) -> Iterator[tuple[int, int]]:
    """First and last instance of each reference cycle; iterative, as files may nest deeply."""
    done: set[int] = set()
    for root in edges:
        path: dict[int, Iterator[int]] = {}
        current = None if root in done else root
        while current is not None:
            pending = path.setdefault(current, iter(edges.get(current, ())))
            step = next((id for id in pending if id not in done), None)
            if step is None:
                path.pop(current)
                done.add(current)
                current = next(reversed(path), None)
            elif step in path:
                yield step, current
            else:
                current = step


T = TypeVar("T")

OPTIMISATION = "its_optimisation"
OPTIMISATION_POSITION = 8
"""Position of the surplus attribute in Fig. 11 of paper 002: after its_machine_functions."""

_PARTS = {
    "geometry": "ISO 10303-42",
    "milling": "ISO 14649-11",
    "optimisation": "optimisation.exp",
    "technology": "ISO 14649-11",
    "tools": "ISO 14649-111",
    "turning": "ISO 14649-12",
    "turning_tools": "ISO 14649-121",
}
"""Standards by entity module; all other modules follow ISO 14649-10."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BoundEntity:
    """Entity with remarks about its instance."""

    entity: Entity
    remarks: tuple[tuple[str, ConversionRemark], ...]
    """Attributes and remarks; an empty name means the whole instance."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Inspection:
    """Findings about one instance, and its references."""

    findings: tuple[Finding, ...]
    references: tuple[int, ...]
    """Ids of referenced instances, except the optimisation, which refers back to operations."""


_VALUES = (str, int, float, tuple, Typed, Derived)
"""Types of values that stand in an entity where the schema requires another entity."""

_DISPENSABLE = ("its_secplane", "implicit_tolerance")
"""Required attributes that many files lack, and that are read as not given."""


def is_about_values(error: Exception) -> bool:
    """True if an error can come from values of a file, and not from the code alone.

    Code that asks an object of its own for an attribute that it does not have is wrong,
    whatever the file holds.
    """
    if not isinstance(error, AttributeError):
        return True
    return error.obj is None or isinstance(error.obj, (Entity, *_VALUES))


def is_of_file(error: Exception, fault: Finding | None) -> bool:
    """True if an error comes from the values of a file, given the fault found near them.

    Without a fault the error itself must show that a value is missing, empty or out of range:
    an optional attribute that is not given is no fault of its own.
    """
    if not is_about_values(error):
        return False
    if fault is not None:
        return True
    if isinstance(error, AttributeError):
        return error.obj is None
    return not isinstance(error, TypeError) or "NoneType" in str(error)


class Model:
    """Entities of one file, bound on request.

    The object has state: entities are cached once bound.
    """

    def __init__(self, file: Part21File) -> None:
        self.file = file
        self._bound: dict[int, Entity | None] = {}

    def get(self, ref: Ref[T], /) -> T:
        """Entity behind a reference.

        Raises
        ------
        SchemaError
            If the instance does not exist, is malformed, or has no entity class.
        """
        found = self.entity(int(ref))
        if found is None:
            raise self._refusal(int(ref))
        return cast("T", found)

    def entity(self, id: int, /) -> Entity | None:
        """Entity of an instance; None where :meth:`get` raises."""
        if id not in self._bound:
            self._bound[id] = _entity_of(self.file, id)
        return self._bound[id]

    def of_type(self, cls: type[T]) -> Iterator[tuple[Ref[T], T]]:
        """Instances of a class and its subclasses that can be bound, in file order."""
        named = [(keyword, bound) for keyword, bound in classes().items()]
        named += [(keyword, bound) for (keyword, _), bound in BY_ARITY.items()]
        keywords = {keyword for keyword, bound in named if issubclass(bound, cls)}
        ids = [id for keyword in keywords for id in self.file.ids_of(keyword)]
        for id in sorted(ids, key=self.file.span):
            entity = self.entity(id)
            if isinstance(entity, cls):
                yield Ref[T](id), entity

    def position(self, ref: Ref[Any], attribute: str) -> int:
        """Position of an attribute among the parameters of its instance, counted from 0.

        For an attribute that the instance lacks, the position where it belongs, beyond the
        parameters; ``its_optimisation`` belongs at the very end.

        Raises
        ------
        ValueError
            If the entity has no such attribute.
        """
        cls = type(cast("Entity", self.get(ref)))
        values = self.file.parameters(int(ref))
        surplus = _optimisation_at(self.file, cls, values)
        names = attributes(cls)
        if attribute == OPTIMISATION and issubclass(cls, MachiningOperation):
            return max(len(values), len(names)) if surplus is None else surplus
        if attribute not in names:
            raise ValueError(f"{cls.__name__} has no attribute {attribute}")
        index = names.index(attribute)
        return index + 1 if surplus is not None and surplus <= index else index

    def findings(self) -> tuple[Finding, ...]:
        """Deviations from the schema, in file order; this binds every instance.

        If there are very many findings, the first are listed and the rest counted.
        """
        edges: dict[int, tuple[int, ...]] = {}
        found = FindingList()
        for id in filter(self.file.is_examined, self.file.ids()):
            inspection = _inspect(self.file, id)
            if inspection is not None:
                found.extend(inspection.findings)
                edges[id] = inspection.references
        found.extend(_cycle_findings(self.file, edges))
        found.extend(_unknown_findings(self.file))
        return found.all()

    def fault_near(self, *refs: Ref[Any]) -> Finding | None:
        """Nearest error among instances and their references, else a warning, or None.

        Referenced operations are skipped, because features list the operations of others.
        Attributes that programs are read without are the last to be named.
        """
        queue, warning = list(dict.fromkeys(map(int, refs))), None
        known = set(queue)
        of_file = {
            each.entity: each
            for each in self.file.findings
            if each.severity is Severity.ERROR and each.entity
        }
        for id in queue:
            if of_file and id in self.file and self.file.label(id) in of_file:
                return of_file[self.file.label(id)]
            inspection = _inspect(self.file, id) or Inspection(findings=(), references=())
            for finding in inspection.findings:
                if finding.severity is Severity.ERROR:
                    return finding
                is_better = warning is None or warning.attribute in _DISPENSABLE
                if finding.severity is Severity.WARNING and is_better:
                    warning = finding
            new = [other for other in inspection.references if other not in known]
            known.update(new)
            queue += (n for n in new if not isinstance(self.entity(n), MachiningOperation))
        return warning

    def _refusal(self, id: int) -> SchemaError:
        """Error that explains why an instance has no entity."""
        if id not in self.file:
            return SchemaError("is referenced, but does not exist in the file", entity=f"#{id}")
        message = "this entity type is not supported"
        if not self.file.keyword(id):
            text = f"{_complex_name(self.file, id)} is not supported"
            return SchemaError(text, entity=self.file.label(id), line=self.file.line(id))
        try:
            self.file.parameters(id)
        except Part21Error as error:
            message = str(error)
        return SchemaError(message, entity=self.file.label(id), line=self.file.line(id))


def bind(
    cls: type[Entity], values: tuple[Value, ...], *, file: Part21File | None = None
) -> BoundEntity:
    """Build an entity of a class from its parameters.

    Parameters
    ----------
    cls : type
    file : Part21File, optional
        File in which references are looked up, to recognise a reference to an optimisation.
    """
    slots = slots_of(cls)
    given, optimisation = _without_optimisation(file, cls, values)
    bound: dict[str, object] = {}
    remarks: list[tuple[str, ConversionRemark]] = []
    for index, (name, slot) in enumerate(slots.items()):
        taken = take(slot, given[index]) if index < len(given) else take_missing(slot)
        bound[name], remark = taken
        if remark is not None:
            remarks.append((name, remark))
    if len(given) > len(slots):
        text = (
            f"{len(given)} attributes, {len(slots)} expected: the surplus is kept but ignored"
        )
        remarks.append(("", ConversionRemark(Severity.WARNING, text)))
    if optimisation is not None:
        bound[OPTIMISATION] = optimisation
    return BoundEntity(entity=cls(**bound), remarks=tuple(remarks))


def to_parameters(entity: Entity) -> tuple[Value, ...]:
    """Part 21 parameters of an entity, with the reference to its optimisation last.

    This is the inverse of :func:`bind`.
    """
    slots = slots_of(type(entity))
    values = [give(slot, getattr(entity, name)) for name, slot in slots.items()]
    optimisation: Ref[object] | None = getattr(entity, OPTIMISATION, None)
    return (*values, optimisation) if optimisation is not None else tuple(values)


def _entity_of(file: Part21File, id: int) -> Entity | None:
    """Entity of one instance; None if it cannot be bound."""
    printed = _printed(file, id)
    if printed is not None:
        return printed.entity
    found = _read(file, id)
    return None if found is None else bind(*found, file=file).entity


def _printed(file: Part21File, id: int) -> ConsistentRecord | None:
    """Record in the form of paper 002, Fig. 11; None for every other instance."""
    if id not in file or file.keyword(id) not in PRINTED:
        return None
    try:
        values = file.parameters(id)
    except Part21Error:
        return None
    return read_printed(file.keyword(id), values, label=file.label(id), line=file.line(id))


def _read(file: Part21File, id: int) -> tuple[type[Entity], tuple[Value, ...]] | None:
    """Class and parameters of an instance that can be bound, or None."""
    if id not in file:
        return None
    try:
        if not file.keyword(id):
            return flattened(dict(file.parts(id)))
        if file.keyword(id) not in classes():
            return None
        values = file.parameters(id)
    except Part21Error:
        return None
    cls = class_of(file.keyword(id), len(values))
    return None if cls is None else (cls, values)


def _without_optimisation(
    file: Part21File | None, cls: type[Entity], values: tuple[Value, ...]
) -> tuple[tuple[Value, ...], Ref[object] | None]:
    """Parameters in EXPRESS order, and the optimisation reference found among them."""
    place = _optimisation_at(file, cls, values)
    if place is None:
        return values, None
    surplus = values[place]
    reference = surplus if isinstance(surplus, Ref) else None
    return values[:place] + values[place + 1 :], reference


def _optimisation_at(
    file: Part21File | None, cls: type[Entity], values: tuple[Value, ...]
) -> int | None:
    """Position of an operation's reference to its optimisation, or None."""
    if not issubclass(cls, MachiningOperation):
        return None
    names = attributes(cls)
    if len(values) > OPTIMISATION_POSITION:
        value = values[OPTIMISATION_POSITION]
        slot = slots_of(cls).get(names[OPTIMISATION_POSITION])
        is_alien = len(values) == len(names) + 1 and slot is not None and not slot.references
        if isinstance(value, Ref) and (is_alien or _is_optimisation(file, value)):
            return OPTIMISATION_POSITION
    if len(values) > len(names) and isinstance(values[len(names)], Ref | None):
        return len(names)
    return None


def _is_optimisation(file: Part21File | None, ref: Ref[object]) -> bool:
    """True if a reference leads to an optimisation entity."""
    return (
        file is not None
        and int(ref) in file
        and file.keyword(int(ref)).endswith("OPTIMISATION")
    )


def _inspect(file: Part21File, id: int) -> Inspection | None:
    """Inspect one instance; None if it cannot be bound."""
    printed = _printed(file, id)
    if printed is not None:
        return Inspection(findings=printed.findings, references=())
    found = _read(file, id)
    if found is None:
        return None
    cls, values = found
    findings = [
        _finding(file, id, name, remark=remark, rule=_rule(cls))
        for name, remark in bind(cls, values, file=file).remarks
    ]
    given, optimisation = _without_optimisation(file, cls, values)
    references = list(_references(cls, given))
    faults = (
        _reference_findings(file, id, name, ref=ref, slot=slot)
        for name, ref, slot in references
    )
    # A list may hold a quarter of a million dangling references.
    findings += islice(chain.from_iterable(faults), MOST_FINDINGS)
    if optimisation is not None:
        findings += _reference_findings(
            file, id, OPTIMISATION, ref=optimisation, slot=AttributeSlot(references=(Entity,))
        )
    return Inspection(
        findings=tuple(findings),
        references=tuple(dict.fromkeys(int(ref) for _, ref, _ in references)),
    )


def _references(
    cls: type[Entity], values: tuple[Value, ...]
) -> Iterator[tuple[str, Ref[object], AttributeSlot]]:
    """References of an instance with their attributes, including those in lists."""
    for (name, slot), value in zip(slots_of(cls).items(), values, strict=False):
        if isinstance(value, Ref):
            yield name, value, slot.items or slot
        elif isinstance(value, tuple) and slot.items is not None:
            yield from ((name, item, slot.items) for item in value if isinstance(item, Ref))


def _reference_findings(
    file: Part21File, id: int, name: str, *, ref: Ref[object], slot: AttributeSlot
) -> Iterator[Finding]:
    """Findings about a dangling reference or one to the wrong kind of instance."""
    if int(ref) not in file:
        remark = ConversionRemark(Severity.ERROR, f"{ref} does not exist in this file")
        yield _finding(file, id, name, remark=remark, rule="ISO 10303-21")
        return
    target = classes().get(file.keyword(int(ref)))
    if target is None or not slot.references or issubclass(target, slot.references):
        return
    wanted = " or ".join(cls.__name__ for cls in slot.references)
    remark = ConversionRemark(
        Severity.ERROR, f"{file.label(int(ref))} is referenced where {wanted} is expected"
    )
    yield _finding(file, id, name, remark=remark, rule=_rule(target))


def _cycle_findings(
    file: Part21File, edges: Mapping[int, tuple[int, ...]]
) -> Iterator[Finding]:
    """Findings about instances that contain themselves, which ISO 14649 does not allow."""
    for id, last in circles(edges):
        remark = ConversionRemark(Severity.ERROR, f"contains itself: #{last} refers back to it")
        yield _finding(file, id, "", remark=remark, rule="ISO 14649-10")


def _unknown_findings(file: Part21File) -> Iterator[Finding]:
    """One note for each keyword without an entity class."""
    unknown: dict[str, list[int]] = {}
    for id in file.ids():
        keyword = file.keyword(id) or _complex_name(file, id)
        if keyword not in classes() and _read(file, id) is None:
            unknown.setdefault(keyword, []).append(id)
    for keyword, ids in unknown.items():
        count = f" ({len(ids)} instances)" if len(ids) > 1 else ""
        text = f"{keyword}{count} is not supported and kept unchanged"
        yield _finding(
            file, ids[0], "", remark=ConversionRemark(Severity.NOTE, text), rule="ISO 14649"
        )


def _finding(
    file: Part21File, id: int, attribute: str, *, remark: ConversionRemark, rule: str
) -> Finding:
    """Convert a remark about an instance to a finding."""
    return Finding(
        severity=remark.severity,
        message=remark.message,
        entity=file.label(id),
        attribute=attribute,
        line=file.line(id),
        rule=rule,
    )


def _rule(cls: type[Entity]) -> str:
    """Standard that defines an entity class."""
    return _PARTS.get(cls.__module__.rpartition(".")[2], "ISO 14649-10")


def _complex_name(file: Part21File, id: int) -> str:
    """Name of a complex instance in messages: its entities, the first three of them."""
    names = [keyword for keyword, _ in file.parts(id)]
    more = f" and {len(names) - 3} more" if len(names) > 3 else ""
    return f"the complex instance ({' '.join(names[:3])}{more})"
