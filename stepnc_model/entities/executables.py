"""Projects, setups and executables: workplans, workingsteps, probing, functions (ISO 14649-10).

The project is the root of a program, with owner, date and status. Turning workingsteps are
those of ISO 14649-12. Lengths are in mm.
"""

from __future__ import annotations

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.enums import AheadOrBehind
from stepnc_model.entities.geometry import (
    AdvancedBrepShapeRepresentation,
    Axis2Placement3d,
    Block,
    BoundedSurface,
    CartesianPoint,
    Direction,
    ElementarySurface,
    RightCircularCylinder,
)
from stepnc_model.entities.measures import (
    BooleanExpression,
    NcConstant,
    NcVariable,
    TolerancedLengthMeasure,
)
from stepnc_model.entities.operations import MachiningOperation, ToolpathList
from stepnc_model.entities.profiles import ManufacturingFeature
from stepnc_model.entities.technology import ToolDirection
from stepnc_model.entities.tools import MachiningTool, TouchProbe
from stepnc_model.entities.turning import TurningMachiningOperation
from stepnc_model.entities.workpiece import Workpiece
from stepnc_model.part21.values import Ref


class OffsetVector(Entity):
    """Offset measured by the control, in three variables."""

    translate: tuple[Ref[NcVariable], ...]
    rotate: tuple[Ref[NcVariable], ...] | None = None


class SetupInstruction(Entity):
    """Instruction for the operator of a setup."""

    description: str | None = None
    external_document: str | None = None


class WorkpieceSetup(Entity):
    """Workpiece in a setup; ``its_origin`` is in setup coordinates."""

    its_workpiece: Ref[Workpiece]
    its_origin: Ref[Axis2Placement3d]
    its_offset: Ref[OffsetVector] | None = None
    its_restricted_area: (
        Ref[BoundedSurface | Block | RightCircularCylinder | AdvancedBrepShapeRepresentation]
        | None
    ) = None
    its_instructions: tuple[Ref[SetupInstruction], ...]


class Setup(Entity):
    """Setup of workpieces on the machine; ``its_origin`` is in machine coordinates."""

    its_id: str
    its_origin: Ref[Axis2Placement3d] | None = None
    its_secplane: Ref[ElementarySurface]
    its_workpiece_setup: tuple[Ref[WorkpieceSetup], ...]


class Executable(Entity, abstract=True):
    """Executable, anything that a control can run."""

    its_id: str


class Channel(Entity):
    """Channel of a control."""

    its_id: str


class InProcessGeometry(Entity):
    """Shape before and after a workingstep, and the removed volume."""

    as_is: Ref[AdvancedBrepShapeRepresentation] | None = None
    to_be: Ref[AdvancedBrepShapeRepresentation] | None = None
    removal: Ref[AdvancedBrepShapeRepresentation] | None = None


class Workingstep(Executable, abstract=True):
    """Workingstep, an executable with a security plane."""

    its_secplane: Ref[ElementarySurface]


class MachiningWorkingstep(Workingstep):
    """Machining of one feature by one operation."""

    its_feature: Ref[ManufacturingFeature]
    its_operation: Ref[MachiningOperation]
    its_effect: Ref[InProcessGeometry] | None = None


class TurningWorkingstep(Workingstep):
    """Machining of several features by one turning operation."""

    its_features: tuple[Ref[ManufacturingFeature], ...]
    its_operation: Ref[TurningMachiningOperation]
    its_effect: Ref[InProcessGeometry] | None = None


class RapidMovement(Workingstep):
    """Movement in rapid; includes the attributes of the second supertype, ``operation``."""

    its_toolpath: Ref[ToolpathList] | None = None
    its_tool_direction: Ref[ToolDirection] | None = None


class ReturnHome(RapidMovement):
    """Rapid movement to the home position."""


class ProgramStructure(Executable, abstract=True):
    """Program structure, an executable that contains others."""


class Workplan(ProgramStructure):
    """Workplan, executables in sequence."""

    its_elements: tuple[Ref[Executable], ...]
    its_channel: Ref[Channel] | None = None
    its_setup: Ref[Setup] | None = None
    its_effect: Ref[InProcessGeometry] | None = None


class Parallel(ProgramStructure):
    """Executables to run at the same time."""

    branches: tuple[Ref[Executable], ...]


class NonSequential(ProgramStructure):
    """Executables to run in any order."""

    its_elements: tuple[Ref[Executable], ...]


class Selective(ProgramStructure):
    """Choice of one among several executables."""

    its_elements: tuple[Ref[Executable], ...]


class IfStatement(ProgramStructure):
    """Conditional execution of one of two executables."""

    condition: Ref[BooleanExpression]
    true_branch: Ref[Executable]
    false_branch: Ref[Executable] | None = None


class WhileStatement(ProgramStructure):
    """Repeated execution while a condition holds."""

    condition: Ref[BooleanExpression]
    body: Ref[Executable]


class Assignment(ProgramStructure):
    """Assignment of a value to a variable."""

    its_lvalue: Ref[NcVariable]
    its_rvalue: Ref[NcVariable | NcConstant]


class NcFunction(Executable, abstract=True):
    """NC function, a switching action or message."""


class DisplayMessage(NcFunction):
    """Message on the screen."""

    its_text: str


class OptionalStop(NcFunction):
    """Program stop that applies only if the optional stop switch is on."""


class ProgramStop(NcFunction):
    """Program stop until the operator restarts."""


class LoadTool(NcFunction):
    """Loading of a tool into the spindle."""

    its_tool: Ref[MachiningTool]


class UnloadTool(NcFunction):
    """Unloading of the tool from the spindle."""

    its_tool: Ref[MachiningTool] | None = None


class SetMark(NcFunction):
    """Mark that other channels can wait for."""


class WaitForMark(NcFunction):
    """Waiting for the mark of another channel."""

    its_channel: Ref[Channel]


class ExchangePallet(NcFunction):
    """Exchange of the pallet."""


class IndexPallet(NcFunction):
    """Indexing of the pallet to a position."""

    its_index: int


class IndexTable(NcFunction):
    """Indexing of the table to a position."""

    its_index: int


class TouchProbing(Workingstep, abstract=True):
    """Touch probing; includes the attributes of the second supertype, ``operation``."""

    its_toolpath: Ref[ToolpathList] | None = None
    its_tool_direction: Ref[ToolDirection] | None = None
    measured_offset: Ref[NcVariable]


class WorkpieceProbing(TouchProbing):
    """Probing of one point of the workpiece."""

    start_position: Ref[Axis2Placement3d]
    its_workpiece: Ref[Workpiece]
    its_direction: Ref[Direction]
    expected_value: Ref[TolerancedLengthMeasure]
    its_probe: Ref[TouchProbe]


class WorkpieceCompleteProbing(TouchProbing):
    """Probing of the workpiece's position and orientation."""

    its_workpiece: Ref[Workpiece]
    probing_distance: Ref[TolerancedLengthMeasure]
    its_probe: Ref[TouchProbe]
    computed_offset: Ref[OffsetVector]


class ToolProbing(TouchProbing, abstract=True):
    """Probing of a tool."""

    offset: Ref[CartesianPoint]
    max_wear: float
    its_tool: Ref[MachiningTool]


class ToolLengthProbing(ToolProbing):
    """Probing of a tool's length."""


class ToolRadiusProbing(ToolProbing):
    """Probing of a tool's radius."""


class Person(Entity):
    """Person (ISO 10303-41)."""

    id: str
    last_name: str | None = None
    first_name: str | None = None
    middle_names: tuple[str, ...] | None = None
    prefix_titles: tuple[str, ...] | None = None
    suffix_titles: tuple[str, ...] | None = None


class Address(Entity):
    """Address (ISO 10303-41)."""

    internal_location: str | None = None
    street_number: str | None = None
    street: str | None = None
    postal_box: str | None = None
    town: str | None = None
    region: str | None = None
    postal_code: str | None = None
    country: str | None = None
    facsimile_number: str | None = None
    telephone_number: str | None = None
    electronic_mail_address: str | None = None
    telex_number: str | None = None


class PersonAndAddress(Entity):
    """Person with address, the owner of a project."""

    its_person: Ref[Person]
    its_address: Ref[Address] | None = None


class CalendarDate(Entity):
    """Calendar date (ISO 10303-41)."""

    year_component: int
    day_component: int
    month_component: int


class CoordinatedUniversalTimeOffset(Entity):
    """Offset of a time zone from universal time (ISO 10303-41)."""

    hour_offset: int
    minute_offset: int | None = None
    sense: AheadOrBehind


class LocalTime(Entity):
    """Time of day (ISO 10303-41)."""

    hour_component: int
    minute_component: int | None = None
    second_component: float | None = None
    zone: Ref[CoordinatedUniversalTimeOffset]


class DateAndTime(Entity):
    """Date and time of day (ISO 10303-41)."""

    date_component: Ref[CalendarDate]
    time_component: Ref[LocalTime]


class ApprovalStatus(Entity):
    """Name of an approval status (ISO 10303-41)."""

    name: str


class Approval(Entity):
    """Approval status with its level (ISO 10303-41)."""

    status: Ref[ApprovalStatus]
    level: str


class Project(Entity):
    """Project, the root of a program."""

    its_id: str
    main_workplan: Ref[Workplan]
    its_workpieces: tuple[Ref[Workpiece], ...]
    its_owner: Ref[PersonAndAddress] | None = None
    its_release: Ref[DateAndTime] | None = None
    its_status: Ref[Approval] | None = None
