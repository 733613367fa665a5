"""Following of reference paths from one instance of an AP238 file to others or to a value."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache

from stepnc_model.ap238.instances import Instances, references
from stepnc_model.ap238.quantity import number_of
from stepnc_model.ap238.table import PathCondition, PathMove, PathStep, Rule
from stepnc_model.errors import Finding, FindingList, Severity
from stepnc_model.part21.values import Ref, Value

RULE = "ISO 10303-238"

MAX_FOUND = 250_000
"""Greatest number of places that one path may lead to."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Place:
    """Place that a path has led to: an instance or a value, and the way there."""

    id: int
    """Instance, or the one that holds the value."""
    value: Value = None
    """Value; None for an instance."""
    context: int | None = None
    """Representation context that gives the units of geometry."""
    way: tuple[int, ...] = ()
    """Instances passed, from the one of the rule on."""


@cache
def _folded(texts: tuple[str, ...]) -> frozenset[str]:
    """Texts regardless of the case of letters."""
    return frozenset(text.casefold() for text in texts)


class PathFollower:
    """Follower of the paths in one file.

    The object has state: findings about references that lead nowhere.

    Parameters
    ----------
    instances : Instances
    """

    def __init__(self, instances: Instances) -> None:
        self._instances = instances
        self.findings = FindingList()

    def matches(self, id: int, rule: Rule) -> bool:
        """True if an instance is one that a rule describes."""
        place = Place(id=id, way=(id,))
        if not self._is_fitting(place, rule.base):
            return False
        return not rule.proof or bool(self.follow(place, rule.proof))

    def follow(self, start: Place, steps: tuple[PathStep, ...]) -> list[Place]:
        """Places that a path leads to from an instance."""
        places = [start]
        for step in steps:
            places = [
                place
                for each in places
                for place in self._moved(each, step)
                if self._is_fitting(place, step)
            ][:MAX_FOUND]
        return places

    def _moved(self, place: Place, step: PathStep) -> Iterator[Place]:
        """Places one step away, without regard to its conditions."""
        if step.move is PathMove.STAY:
            yield place
            return
        if place.value is not None:
            return
        if step.move is PathMove.FORWARD:
            yield from self._forward(place, step)
            return
        found = self._instances.referrers(place.id, step.entity, step.attribute)
        if step.move is PathMove.USED:
            if found:
                yield place
            return
        for id in self._sorted(found, step.order):
            yield Place(id=id, context=self._context(id, place), way=(*place.way, id))

    def _forward(self, place: Place, step: PathStep) -> Iterator[Place]:
        """Places that an attribute leads to: instances, or else its value."""
        found = self._instances.values(place.id, step.attribute)
        refs = [ref for value in found for ref in references(value)]
        for ref in refs:
            if int(ref) not in self._instances:
                message = f"{ref} does not exist in this file"
                self.remark(Severity.ERROR, message, place.id, step.attribute)
                continue
            yield Place(
                id=int(ref),
                context=self._context(int(ref), place),
                way=(*place.way, int(ref)),
            )
        if not refs:
            value = self._instances.value(place.id, step.attribute)
            if value is None and "" in found:
                value = ""
            if value is not None:
                yield Place(id=place.id, value=value, context=place.context, way=place.way)

    def _sorted(self, found: list[int], order: str) -> list[int]:
        """Instances by an attribute, or in file order."""
        if not order:
            return found
        return sorted(found, key=lambda id: number_of(self._instances.value(id, order)) or 0.0)

    def _context(self, id: int, place: Place) -> int | None:
        """Context of a representation, or that of the place before."""
        value = self._instances.value(id, "context_of_items")
        if isinstance(value, Ref) and self._instances.is_a(
            int(value), "GLOBAL_UNIT_ASSIGNED_CONTEXT"
        ):
            return int(value)
        return place.context

    def _is_fitting(self, place: Place, step: PathStep) -> bool:
        """True if a place fulfils the conditions of a step."""
        if step.types and (
            place.value is not None
            or not all(self._instances.is_a(place.id, name) for name in step.types)
        ):
            return False
        return all(self._is_true(place, condition) for condition in step.conditions)

    def _is_true(self, place: Place, condition: PathCondition) -> bool:
        """True if a condition holds."""
        ids, values = [place.id], list[Value]()
        for name in condition.attributes:
            values = [value for id in ids for value in self._instances.values(id, name)]
            ids = [int(ref) for value in values for ref in references(value)]
            if not values:
                return False
        if condition.type:
            return any(self._instances.is_a(id, condition.type) for id in ids)
        if condition.texts:
            wanted = _folded(condition.texts)
            return any(isinstance(v, str) and v.strip().casefold() in wanted for v in values)
        return any(value not in (None, (), "") for value in values)

    def is_course(self, id: int) -> bool:
        """True if a direction is that of a linear path, such as the course of a depth."""
        name = "DIRECTION_SHAPE_REPRESENTATION"
        return bool(self._instances.referrers(id, name, "items"))

    def remark(self, severity: Severity, message: str, id: int, attribute: str) -> None:
        """Add a finding about an instance of the file."""
        self.findings.add(
            Finding(
                severity=severity,
                message=message,
                entity=self._instances.file.label(id),
                attribute=attribute,
                line=self._instances.file.line(id),
                rule=RULE,
            )
        )
