"""What a program runs, from workplans down to workingsteps (ISO 14649-10 and -12)."""

from __future__ import annotations

from stepnc_model.entities.entity import Entity, abstract, entity
from stepnc_model.entities.expressions import BooleanExpression, NcConstant, NcVariable
from stepnc_model.entities.geometry import AdvancedBrepShapeRepresentation, ElementarySurface
from stepnc_model.entities.operations import MachiningOperation
from stepnc_model.entities.regions import ManufacturingFeature
from stepnc_model.entities.setup import Setup
from stepnc_model.entities.technology import ToolDirection
from stepnc_model.entities.toolpaths import ToolpathList
from stepnc_model.entities.turning import TurningMachiningOperation
from stepnc_model.part21.values import Ref


@abstract
class Executable(Entity):
    """Anything a control can run."""

    its_id: str


@entity
class Channel(Entity):
    """Channel of a control."""

    its_id: str


@entity
class InProcessGeometry(Entity):
    """Shape before, after, and what is removed."""

    as_is: Ref[AdvancedBrepShapeRepresentation] | None = None
    to_be: Ref[AdvancedBrepShapeRepresentation] | None = None
    removal: Ref[AdvancedBrepShapeRepresentation] | None = None


@abstract
class Workingstep(Executable):
    """Step that works above a security plane."""

    its_secplane: Ref[ElementarySurface]


@entity
class MachiningWorkingstep(Workingstep):
    """One operation on one feature."""

    its_feature: Ref[ManufacturingFeature]
    its_operation: Ref[MachiningOperation]
    its_effect: Ref[InProcessGeometry] | None = None


@entity
class TurningWorkingstep(Workingstep):
    """One turning operation on several features."""

    its_features: tuple[Ref[ManufacturingFeature], ...]
    its_operation: Ref[TurningMachiningOperation]
    its_effect: Ref[InProcessGeometry] | None = None


@entity
class RapidMovement(Workingstep):
    """Movement in rapid; the second supertype, ``operation``, is spelt out."""

    its_toolpath: Ref[ToolpathList] | None = None
    its_tool_direction: Ref[ToolDirection] | None = None


@entity
class ReturnHome(RapidMovement):
    """Movement to the home position."""


@abstract
class ProgramStructure(Executable):
    """What holds other executables."""


@entity
class Workplan(ProgramStructure):
    """Executables one after another."""

    its_elements: tuple[Ref[Executable], ...]
    its_channel: Ref[Channel] | None = None
    its_setup: Ref[Setup] | None = None
    its_effect: Ref[InProcessGeometry] | None = None


@entity
class Parallel(ProgramStructure):
    """Executables at the same time."""

    branches: tuple[Ref[Executable], ...]


@entity
class NonSequential(ProgramStructure):
    """Executables in any order."""

    its_elements: tuple[Ref[Executable], ...]


@entity
class Selective(ProgramStructure):
    """One of several executables."""

    its_elements: tuple[Ref[Executable], ...]


@entity
class IfStatement(ProgramStructure):
    """One executable or the other."""

    condition: Ref[BooleanExpression]
    true_branch: Ref[Executable]
    false_branch: Ref[Executable] | None = None


@entity
class WhileStatement(ProgramStructure):
    """Executable repeated."""

    condition: Ref[BooleanExpression]
    body: Ref[Executable]


@entity
class Assignment(ProgramStructure):
    """Variable gets a value."""

    its_lvalue: Ref[NcVariable]
    its_rvalue: Ref[NcVariable | NcConstant]
