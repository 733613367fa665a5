"""Editing a program by attribute names, on top of byte-exact edits of the file.

Instances may be shorter than their entity (older editions) or have the surplus reference to an
optimisation in their middle; a draft tracks the position of each attribute after removals, and
fills missing trailing parameters with ``$``.
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Any, cast

from stepnc_model.entities.entity import Entity, attributes
from stepnc_model.part21.values import Ref, Value
from stepnc_model.part21.writer import Edits
from stepnc_model.programs.binding import to_parameters
from stepnc_model.programs.program import Program


class Draft:
    """Edits of one program, collected until ``edits.apply()`` is called."""

    def __init__(self, program: Program) -> None:
        self.program = program
        self.edits = Edits(program.file)
        self.removed: set[int] = set()
        self.has_surplus = False
        """Whether an operation was given a reference to an optimisation."""
        self._gaps: dict[int, int] = {}
        self._lengths: dict[int, int] = {}
        self._uses: Counter[int] | None = None
        self._own: dict[tuple[int, str], Ref[Any]] = {}

    def add(self, entity: Entity) -> Ref[Any]:
        """Add an instance for an entity; return its reference."""
        return cast("Ref[Any]", self.edits.add(entity.keyword, to_parameters(entity)))

    def add_like(self, ref: Ref[Any], values: tuple[Value, ...]) -> Ref[Any]:
        """Add an instance with the same keyword as another; return its reference."""
        keyword = self.program.file.keyword(int(ref))
        added = cast("Ref[Any]", self.edits.add(keyword, values))
        self._lengths[int(added)] = len(values)
        return added

    def put(
        self, owner: Ref[Any], attribute: str, value: Value, *, at: Ref[Any] | None = None
    ) -> None:
        """Set the value of an attribute of an instance.

        Parameters
        ----------
        owner : Ref
            Instance of the file that defines the attribute's position.
        at : Ref, optional
            Copy of the owner that is edited instead of it.
        """
        holder = int(at if at is not None else owner)
        place = self.program.model.position(owner, attribute)
        if place > self._gaps.get(holder, place):
            place -= 1
        self._fill(holder, place + 1)
        self.edits.replace_parameter(holder, place, value)

    def append_surplus(self, owner: Ref[Any], value: Value) -> None:
        """Add a parameter after the last attribute of the entity."""
        self._fill(int(owner), len(attributes(self.program.get(owner))))
        self.edits.append_parameter(int(owner), value)
        self.has_surplus = True
        self._lengths[int(owner)] += 1

    def drop_surplus(self, owner: Ref[Any]) -> None:
        """Remove the surplus reference to an optimisation."""
        place = self.program.model.position(owner, "its_optimisation")
        self.edits.remove_parameter(int(owner), place)
        self._lengths[int(owner)] = self._length(int(owner)) - 1
        self._gaps[int(owner)] = place

    def uses(self, ref: Ref[Any]) -> int:
        """Number of references to an instance in the file."""
        return self._use_counts()[int(ref)]

    def remove(self, numbers: Sequence[int]) -> None:
        """Remove instances from the file, each once."""
        for number in numbers:
            if number not in self.removed:
                self.edits.remove(number)
                self.removed.add(number)

    def only_under(self, reference: Ref[Any], keywords: frozenset[str]) -> list[int]:
        """Instances that only one instance refers to, and those that only they refer to.

        Parameters
        ----------
        reference : Ref
            Instance to which one other instance may refer.
        keywords : frozenset of str
            Keywords of the instances to be found.

        Returns
        -------
        list of int
            The instance first; empty if several others refer to it.
        """
        file, uses = self.program.file, self._use_counts()
        found: list[int] = []
        met: Counter[int] = Counter([int(reference)])
        waiting = [int(reference)]
        while waiting:
            number = waiting.pop()
            is_ours = number in file and file.keyword(number) in keywords
            if not is_ours or met[number] < uses[number]:
                continue
            found.append(number)
            inner = [int(each) for each in references(file.parameters(number))]
            met.update(inner)
            waiting += [each for each in dict.fromkeys(inner) if met[each] == uses[each]]
        return found

    def own(
        self,
        owner: Ref[Any],
        attribute: str,
        *,
        at: Ref[Any] | None = None,
        parts: Sequence[Ref[Any]] = (),
    ) -> Ref[Any]:
        """Instance that an attribute refers to; it is copied first if others use it too.

        Parameters
        ----------
        at : Ref, optional
            Copy of the owner that is edited instead of it.
        parts : sequence of Ref
            Parts of the owner whose attribute of the same name refers to that instance too.
        """
        holder = at if at is not None else owner
        key = (int(holder), attribute)
        if key not in self._own:
            reference: Ref[Any] = getattr(self.program.get(owner), attribute)
            self._own[key] = self._unshared(owner, attribute, reference, at=holder, parts=parts)
        return self._own[key]

    def _unshared(
        self,
        owner: Ref[Any],
        attribute: str,
        reference: Ref[Any],
        *,
        at: Ref[Any],
        parts: Sequence[Ref[Any]],
    ) -> Ref[Any]:
        """Return the referenced instance if unshared, else a copy for the holder."""
        uses, own_uses = self._use_counts(), 1 + len(parts)
        if uses[int(reference)] <= own_uses:
            return reference
        values = self.program.file.parameters(int(reference))
        copy = self.add_like(reference, values)
        uses[int(reference)] -= own_uses
        uses[int(copy)] = own_uses
        # The instances that the original refers to are now used by the copy as well.
        uses.update(int(inner) for inner in references(values))
        self.put(owner, attribute, copy, at=at)
        for part in parts:
            self.put(part, attribute, copy)
        return copy

    def _use_counts(self) -> Counter[int]:
        """Number of references to each instance in the file."""
        if self._uses is None:
            file = self.program.file
            self._uses = Counter(
                int(reference)
                for number in file.ids()
                for _, values in file.parts(number)
                for reference in references(values)
            )
        return self._uses

    def _length(self, number: int) -> int:
        """Current number of parameters of an instance."""
        if number not in self._lengths:
            self._lengths[number] = len(self.program.file.parameters(number))
        return self._lengths[number]

    def _fill(self, number: int, count: int) -> None:
        """Extend an instance to a number of parameters with ``$``."""
        for _ in range(count - self._length(number)):
            self.edits.append_parameter(number, None)
            self._lengths[number] += 1


def references(values: tuple[Value, ...]) -> Iterator[Ref[object]]:
    """All references among values, including those in lists."""
    for value in values:
        if isinstance(value, Ref):
            yield value
        elif isinstance(value, tuple):
            yield from references(value)
