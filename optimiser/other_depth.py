"""Program with another depth of its passes, as :mod:`stepnc_model.writeback` would write it."""

from copy import copy
from dataclasses import replace
from typing import Any

from stepnc_model.binding import Model
from stepnc_model.entities.entity import Entity
from stepnc_model.errors import PathError
from stepnc_model.part21.values import Ref
from stepnc_model.program import Program, ResolvedWorkingstep


def with_depth(
    program: Program, step: ResolvedWorkingstep, depth: float
) -> tuple[Program, ResolvedWorkingstep]:
    """Copy of a program and a workingstep with a different depth of its passes.

    Raises
    ------
    PathError
        When the file does not let the depth be chosen.
    """
    operation: Any = step.operation
    if hasattr(operation, "axial_cutting_depth") and not operation.its_toolpath:
        other = replace(operation, axial_cutting_depth=depth)
        return program, replace(step, operation=other)
    strategy: Ref[Entity] | None = getattr(operation, "its_machining_strategy", None)
    entity: Any = None if strategy is None else program.get(strategy)
    if strategy is None or not hasattr(entity, "cutting_depth") or operation.its_toolpath:
        raise PathError("the file sets no depth of its passes", entity=str(step.ref))
    changed = copy(program)
    changed.model = _Changed(program.model, strategy, replace(entity, cutting_depth=(depth,)))
    return changed, step


class _Changed(Model):
    """Entities of a program with one entity replaced."""

    def __init__(self, model: Model, ref: Ref[Entity], entity: Entity) -> None:
        super().__init__(model.file)
        self._model, self._number, self._entity = model, int(ref), entity

    def entity(self, id: int, /) -> Entity | None:
        """Return the entity of an instance number."""
        return self._entity if id == self._number else self._model.entity(id)
