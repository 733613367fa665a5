"""Withdrawal of given data from a program that was advised on their basis.

What was given then stands nowhere in the file, and what was advised does.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import isclose
from typing import Any

from stepnc_model.ap238.table import Converted
from stepnc_model.ap238.view import AimView
from stepnc_model.ap238.writing import spliced_into
from stepnc_model.editing.draft import Draft
from stepnc_model.editing.user_data import Completed, SetAttribute, origin_in
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref, Value
from stepnc_model.programs.program import Program


def without_user_data(program: Program, whole: Completed) -> bytes:
    """Bytes of a program with given data withdrawn, where they were not changed since.

    What was copied for a workingstep, such as a technology that others use too, is without
    them as well. In an AP238 file, users of a tool and the like may be listed in another order.

    Parameters
    ----------
    program : Program
        Program that holds the given data, and perhaps advice.
    whole : Completed
        The program as it was with the given data, and these.

    Returns
    -------
    bytes
    """
    given = (*whole.attributes, *_of_copies(program, whole))
    if isinstance(program.file, AimView):
        old = whole.program.file
        before = old.source if isinstance(old, AimView) else old
        withdrawal = _AimWithdrawal(program, program.file, before)
        for each in given:
            withdrawal.withdraw(each)
        return withdrawal.apply()
    draft = Draft(program)
    for each in given:
        if all(_is_kept(program, other) for other in _together(given, each)):
            draft.put(each.ref, each.attribute, each.before)
            draft.remove(each.added)
    return draft.edits.apply()


def _of_copies(program: Program, whole: Completed) -> Iterator[SetAttribute]:
    """Given data in the copies that a workingstep has instead of what they were given to."""
    before = {int(step.ref): step for step in whole.program.workingsteps}
    seen: set[tuple[int, str]] = set()
    for step in program.workingsteps:
        old = before.get(int(step.ref))
        if old is None:
            continue
        for name in ("operation_ref", "technology_ref", "functions_ref"):
            one, other = getattr(old, name), getattr(step, name)
            if one is None or _is_alike(program, other, whole.program, one):
                continue
            for each in whole.attributes:
                if each.ref == one and (int(other), each.attribute) not in seen:
                    seen.add((int(other), each.attribute))
                    yield replace(each, ref=other, origin=origin_in(program, other))


def _is_alike(program: Program, ref: Ref[Any], before: Program, old: Ref[Any]) -> bool:
    """True if an instance of a changed program is the one that it was before."""
    now, then = origin_in(program, ref), origin_in(before, old)
    if now is None or then is None:
        return ref == old
    return (now.origin, now.keyword) == (then.origin, then.keyword)


def _together(changes: Sequence[SetAttribute], one: SetAttribute) -> Iterator[SetAttribute]:
    """Set attribute, with the one beside which alone it is withdrawn."""
    yield one
    for other in changes:
        if other.ref == one.ref and other.attribute == one.withdrawn_with:
            yield other


def _is_kept(program: Program, change: SetAttribute) -> bool:
    """True if an attribute still has the value that was given."""
    place = program.model.position(change.ref, change.attribute)
    return program.file.parameters(int(change.ref))[place] == change.value


class _AimWithdrawal:
    """Withdrawal from an AP238 program whose numbers may have changed. Running state."""

    def __init__(self, program: Program, view: AimView, before: Part21File) -> None:
        self._draft = Draft(program)
        self._before_given = before
        self._view = view
        self._remembered: list[Converted] = []

    def withdraw(self, change: SetAttribute) -> None:
        """Withdraw one attribute, if it still has the value that was given."""
        view = self._view
        number = None if change.origin is None else view.number_of(change.origin)
        if number is None:
            return
        ref: Ref[object] = Ref(number)
        place = self._draft.program.model.position(ref, change.attribute)
        value = view.parameters(number)[place]
        if not self._is_kept(value, change):
            return
        self._draft.put(ref, change.attribute, self._before(change))
        if change.added and isinstance(value, Ref):
            self._draft.remove(tuple(_below(view, value)))

    def _is_kept(self, value: Value, change: SetAttribute) -> bool:
        """True if a value is the one that was given."""
        if not isinstance(value, Ref) or not isinstance(change.value, Ref):
            return _is_same(value, change.value)
        origin = change.value_origin
        return origin is None or self._view.number_of(origin) == int(value)

    def _before(self, change: SetAttribute) -> Value:
        """Previous value, under the number that it has now."""
        origin = change.before_origin
        if origin is None:
            return change.before
        number = self._view.number_of(origin)
        if number is None:
            # Nothing leads to it any more, so that the program as it is does not have it.
            number = int(self._draft.edits.add(origin.keyword, ()))
            self._remembered.append(replace(origin, number=number, rule=None))
        return Ref(number)

    def apply(self) -> bytes:
        """Bytes of the AP238 file."""
        view = self._view.remembering(self._remembered)
        changed = self._draft.edits.apply()
        return spliced_into(view, changed, self._draft.removed, before=self._before_given)


def _is_same(one: Value, other: Value) -> bool:
    """True if two values are the same, but for the digits that a change of unit costs."""
    if isinstance(one, int | float) and isinstance(other, int | float):
        return isclose(one, other, rel_tol=1e-12)
    return one == other


def _below(file: Part21File, ref: Ref[object]) -> Iterator[int]:
    """Instance and all that it refers to."""
    yield int(ref)
    for value in file.parameters(int(ref)):
        if isinstance(value, Ref):
            yield from _below(file, value)
