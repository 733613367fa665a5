"""Inputs of a trial cut, in the user's units: the three panes of [1]_, Fig. 9.

Cutting model of a trial cut: from the user's inputs to the data of machine and loop.

A cutter enters an endless workpiece. While it enters, the arc of contact opens about the feed
direction, as the edge of the workpiece moves from the front of the cutter towards its axis;
then the engagement is constant. The real entry length is half a diameter; here entry takes a
fixed number of revolutions, so that large cutters do not need minutes. All forces come from
:mod:`simulator.physics`, with the library's k_c, uncorrected for a tool.

Units mm, s, N, W, rad, rev/s.

References
----------
.. [1] F. Ridwan, X. Xu, G. Liu, "A framework for machining optimisation based on STEP-NC",
   J. Intell. Manuf., 2010, "Computer model", Figs. 6, 7 and 9, Table 2.
.. [2] F. Ridwan, X. Xu, G. Liu, "A framework for machining optimisation based on STEP-NC",
   J. Intell. Manuf., 2010, eqs. (1) to (6).
"""

from dataclasses import dataclass, fields, replace
from enum import StrEnum
from math import acos, isfinite, pi
from typing import Any

import numpy as np

from controller.orders import Criterion
from controller.reference import ForceBound, Reference
from controller.signals.preview import Preview
from controller.states.loop_settings import LoopStep
from optimiser.solver.problem import LimitName
from service.programs.reading import one_of
from simulator.library import find_grade, load_material, material_names
from simulator.motion.segments import Floats
from simulator.physics import flank, kinematics
from simulator.physics.cutting import cutting_power, motor_power
from simulator.physics.engagement import (
    Engagement,
    bilateral,
    conventional,
    full_immersion,
    mean_chip_ratio,
    unidirectional,
)
from simulator.physics.kinematics import spindle_speed
from simulator.physics.milling import MillingCut, mean_force, mean_specific_force
from simulator.plant.course import EngagedTeeth, NominalCourse, Singles, peak_over_mean
from simulator.spec import CuttingMaterial, Kienzle, ToolKind
from stepnc_model.errors import StepNcError
from stepnc_model.units import rad_from_deg, rpm_from_rev_s, speed_from_m_min, watts_from_kw

MOST_RPM = 12_000.0
"""Largest spindle speed, in rpm: that of the library's machining centre ``vmc15``."""


class MillingType(StrEnum):
    """Milling types by immersion after [1]_, Fig. 6; unidirectional ones by feed direction."""

    FULL = "full"
    """Slot: the width of cut is the cutter diameter."""
    UP = "up"
    """One side of the cutter, conventional milling."""
    DOWN = "down"
    """One side of the cutter, climb milling."""
    SYMMETRIC = "symmetric"
    """Middle of the cutter, bidirectional immersion."""


@dataclass(frozen=True, slots=True, kw_only=True)
class InputField:
    """Numeric input that a user sets, with its unit and bounds."""

    name: str
    """Name of the attribute of :class:`Inputs`."""
    words: str
    unit: str
    """Unit; empty if the number has none."""
    low: float
    high: float
    """Upper bound; both bounds are inclusive."""
    is_whole: bool = False


FIELDS = (
    InputField(name="tool_diameter_mm", words="tool diameter", unit="mm", low=4.0, high=160.0),
    InputField(name="teeth", words="teeth", unit="", low=1, high=16, is_whole=True),
    InputField(
        name="cutting_edge_angle_deg",
        words="cutting edge angle",
        unit="°",
        low=10.0,
        high=90.0,
    ),
    InputField(name="radial_width_mm", words="radial width", unit="mm", low=0.5, high=160.0),
    InputField(
        name="cutting_speed_m_min", words="cutting speed", unit="m/min", low=20.0, high=1000.0
    ),
    InputField(name="efficiency", words="mechanical efficiency", unit="", low=0.3, high=1.0),
    InputField(name="feed_per_tooth_mm", words="chip load", unit="mm", low=0.01, high=1.0),
    InputField(name="axial_depth_mm", words="depth", unit="mm", low=0.1, high=20.0),
    InputField(name="motor_power_kw", words="motor power", unit="kW", low=0.1, high=100.0),
    InputField(name="axial_depth_max_mm", words="allowed depth", unit="mm", low=0.1, high=20.0),
)
"""Numeric inputs with their bounds; values outside are taken for typing errors."""

NUMBERS = {field.name: field for field in FIELDS}


@dataclass(frozen=True, slots=True, kw_only=True)
class Inputs:
    """Inputs of a trial cut; the default is a slot in C45 on a machine of 7.5 kW.

    Efficiency and allowed depth are those of [1]_, Table 2. The rest of that example is a
    cutter with one tooth on a motor of 0.29 kW, in a material with a third of the specific
    force of steel (``paper002`` in the library). Here, chip load limits the feed at 2 mm depth,
    with 65 % of the motor power in use; the motor limits it at 4 mm.

    Raises
    ------
    StepNcError
        When a value is out of bounds, with name, bound and unit.
    """

    milling_type: MillingType = MillingType.FULL
    material: str = "c45"
    """Name of the workpiece material in the library."""
    tool_diameter_mm: float = 50.0
    teeth: int = 4
    """Number of teeth, the flutes of [1]_."""
    cutting_edge_angle_deg: float = 90.0
    """Cutting edge angle, the setting angle χ of [1]_, in °."""
    radial_width_mm: float = 40.0
    """Radial width of cut, in mm; ignored in full milling, where it equals the diameter."""
    cutting_speed_m_min: float = 220.0
    """Cutting speed, in m/min; within the library's window of carbide inserts in C45."""
    efficiency: float = 0.9
    """Efficiency of the main drive."""
    feed_per_tooth_mm: float = 0.2
    """Chip load, in mm: the largest allowed in mode TC, the one kept in mode QC; within the
    library's window of carbide face mills in steel."""
    axial_depth_mm: float = 2.0
    motor_power_kw: float = 7.5
    axial_depth_max_mm: float = 3.0
    """Depth that the machine's capability allows, in mm."""
    mode: Criterion = Criterion.TC
    is_on: bool = True
    """Whether force control is on; if off, the chip load is run whatever the force."""

    def __post_init__(self) -> None:
        for field in FIELDS:
            _require_within(field, getattr(self, field.name))
        if self.material not in material_names():
            known = ", ".join(material_names())
            raise StepNcError(f"unknown material '{self.material}'; known: {known}")
        is_partial = self.milling_type is not MillingType.FULL
        if is_partial and self.radial_width_mm > self.tool_diameter_mm:
            bound = f"at most the tool diameter, {self.tool_diameter_mm:g} mm"
            raise StepNcError(f"radial width {self.radial_width_mm:g} mm: it must be {bound}")
        speed = speed_from_m_min(self.cutting_speed_m_min)
        rpm = rpm_from_rev_s(spindle_speed(self.tool_diameter_mm, speed))
        if rpm > MOST_RPM:
            raise StepNcError(
                f"spindle speed {rpm:.5g} rpm, from cutting speed {self.cutting_speed_m_min:g} "
                f"m/min and tool diameter {self.tool_diameter_mm:g} mm: it must be at most "
                f"{MOST_RPM:g} rpm"
            )


def changed(inputs: Inputs, **changes: Any) -> Inputs:
    """Return the inputs with some of them changed; enumerations may be given as text.

    Raises
    ------
    StepNcError
        When an input is unknown, or a value is out of bounds.
    """
    known = [field.name for field in fields(Inputs)]
    for name in changes:
        if name not in known:
            raise StepNcError(f"unknown input '{name}'; known: {', '.join(known)}")
    if "milling_type" in changes:
        word = str(changes["milling_type"])
        changes["milling_type"] = one_of(MillingType, word, "milling type")
    if "mode" in changes:
        changes["mode"] = one_of(Criterion, str(changes["mode"]).upper(), "mode")
    if not isinstance(changes.get("is_on", True), bool):
        raise StepNcError(f"control '{changes['is_on']}': it must be on or off")
    return replace(inputs, **changes)


def differing(before: Inputs, after: Inputs) -> tuple[str, ...]:
    """Return the names of the inputs that differ."""
    names = (field.name for field in fields(Inputs))
    return tuple(name for name in names if getattr(before, name) != getattr(after, name))


def change_words(before: Inputs, after: Inputs, name: str) -> str:
    """Describe a change of one input for an event, as in ``depth 2 -> 4 mm``."""
    old, new = getattr(before, name), getattr(after, name)
    if name == "is_on":
        return "control off -> on" if new else "control on -> off"
    field = NUMBERS.get(name)
    if field is None:
        return f"{name.replace('_', ' ')} {old} -> {new}"
    return f"{field.words} {old:g} -> {new:g} {field.unit}".rstrip()


def _require_within(field: InputField, value: object) -> None:
    """Refuse a value that is not a number or is out of bounds."""
    bound = f"{field.low:g} to {field.high:g} {field.unit}".rstrip()
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise StepNcError(f"{field.words} '{value}': it must be a number, {bound}")
    if field.is_whole and not (isfinite(value) and float(value).is_integer()):
        raise StepNcError(f"{field.words} {value:g}: it must be a whole number, {bound}")
    if not field.low <= value <= field.high:
        shown = f"{value:g} {field.unit}".rstrip()
        raise StepNcError(f"{field.words} {shown}: it must be {bound}")


NAME = "trial cut"

AIR = 10
"""Revolutions in air before the cut, in which the dynamometer's zero is measured."""

ENTRY = 30
"""Revolutions (and cells) of the entry, more than the loop needs to settle."""

ENDLESS = 1e9
"""Duration of the cut in the program, in s: thirty years."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TrialCut:
    """Fully engaged cut at the programmed chip load, and its drive."""

    cut: MillingCut
    kienzle: Kienzle
    tool_diameter: float
    radial_width: float
    cutting_speed: float
    spindle_speed: float
    efficiency: float

    @property
    def feed(self) -> float:
        """Feed at the programmed chip load, in mm/s."""
        return self.feed_at(self.cut.feed_per_tooth)

    def feed_at(self, feed_per_tooth: float) -> float:
        """Feed at a feed per tooth, in mm/s."""
        return kinematics.feed(feed_per_tooth, self.spindle_speed, teeth=self.cut.teeth)


@dataclass(frozen=True, slots=True, kw_only=True)
class Prediction:
    """Closed-form results at a feed; the governing equations of [2]_."""

    force: float = 0.0
    """Mean cutting force F_mt, in N."""
    power: float = 0.0
    """Power of the motor, in W."""
    removal_rate: float = 0.0
    """Material removal rate, in mm³/s."""
    chip_thickness: float = 0.0
    """Mean chip thickness h_m, in mm."""
    specific_cutting_force: float | None = None
    """Specific cutting force, in N/mm²; None at standstill."""


def trial_cut(inputs: Inputs) -> TrialCut:
    """Build the cut that the inputs describe."""
    engagement = engagement_of(inputs)
    speed = speed_from_m_min(inputs.cutting_speed_m_min)
    is_full = inputs.milling_type is MillingType.FULL
    return TrialCut(
        cut=MillingCut(
            feed_per_tooth=inputs.feed_per_tooth_mm,
            teeth=inputs.teeth,
            axial_depth=inputs.axial_depth_mm,
            engagement=engagement,
            cutting_edge_angle=rad_from_deg(inputs.cutting_edge_angle_deg),
        ),
        kienzle=load_material(inputs.material).kienzle,
        tool_diameter=inputs.tool_diameter_mm,
        radial_width=inputs.tool_diameter_mm if is_full else inputs.radial_width_mm,
        cutting_speed=speed,
        spindle_speed=kinematics.spindle_speed(inputs.tool_diameter_mm, speed),
        efficiency=inputs.efficiency,
    )


def engagement_of(inputs: Inputs) -> Engagement:
    """Arc of contact of the milling type."""
    width, diameter = inputs.radial_width_mm, inputs.tool_diameter_mm
    match inputs.milling_type:
        case MillingType.FULL:
            return full_immersion()
        case MillingType.UP:
            return conventional(width, diameter)
        case MillingType.DOWN:
            return unidirectional(width, diameter)
        case MillingType.SYMMETRIC:
            return bilateral(width, diameter)


def predicted(trial: TrialCut, feed_per_tooth: float) -> Prediction:
    """Closed-form results at a feed per tooth in mm; all zero at standstill."""
    if not feed_per_tooth > 0.0:
        return Prediction()
    cut = replace(trial.cut, feed_per_tooth=feed_per_tooth)
    force = mean_force(trial.kienzle, cut)
    return Prediction(
        force=force,
        power=motor_power(cutting_power(force, trial.cutting_speed), trial.efficiency),
        removal_rate=kinematics.milling_removal_rate(
            trial.feed_at(feed_per_tooth),
            axial_depth=cut.axial_depth,
            radial_width=trial.radial_width,
        ),
        chip_thickness=cut.mean_chip_thickness,
        specific_cutting_force=mean_specific_force(trial.kienzle, cut),
    )


def force_bound(trial: TrialCut, power: float) -> float:
    """Cutting force at a motor power, in N; force and power are proportional."""
    at = predicted(trial, trial.cut.feed_per_tooth)
    return at.force * power / at.power


def course_of(trial: TrialCut) -> NominalCourse:
    """Course of the cut at an override of 1, the full chip load: air, entry, constant cut."""
    arcs = _arcs(trial.cut.engagement)
    forces = [
        0.0 if arc is None else mean_force(trial.kienzle, replace(trial.cut, engagement=arc))
        for arc in arcs
    ]
    lands = [
        0.0 if arc is None else _engaged_width(replace(trial.cut, engagement=arc))
        for arc in arcs
    ]
    force = np.array(forces)
    cuts = force > 0.0
    until = (AIR + np.arange(len(arcs))) / trial.spindle_speed
    until[-1] = ENDLESS
    ends = [(0.0, 0.0) if arc is None else (arc.entry_angle, arc.exit_angle) for arc in arcs]
    entry, exit_ = np.array(ends).T
    widths = 0.5 * trial.tool_diameter * (np.cos(entry) - np.cos(exit_))
    count = len(arcs)
    return NominalCourse(
        until=until,
        can_override=np.ones(count, dtype=bool),
        # Relative to the tool: an endless workpiece has no position.
        position=np.zeros((count, 3), np.float32),
        feed=_single(trial.feed, count),
        programmed=_single(trial.feed, count),
        force=_single(force, count),
        land_force=_single(flank.CUTTING * np.array(lands), count),
        exponent=_single(exponent_of(trial), count),
        removal_rate=_single(trial.cut.axial_depth * widths * trial.feed, count),
        axial_depth=_single(np.where(cuts, trial.cut.axial_depth, 0.0), count),
        # Motor power in the paper is that of the cut alone, eq. (6).
        idle_power=_single(0.0, count),
        spindle_speed=_single(trial.spindle_speed, count),
        diameter=_single(np.where(cuts, trial.tool_diameter, 0.0), count),
        entry_angle=_single(entry, count),
        exit_angle=_single(exit_, count),
        peak=_single(np.array([_peak(trial, arc) for arc in arcs]), count),
        wall=_single(0.0, count),
        lag=_single(0.0, count),
        teeth=np.full(count, trial.cut.teeth),
        tool=np.ones(count, dtype=np.int64),
        workingstep=np.ones(count, dtype=np.int64),
        line=np.ones(count, dtype=np.int64),
    )


def preview_of(course: NominalCourse) -> Preview:
    """Preview of the cut for the loop."""
    return Preview(
        until=course.until,
        force=course.force,
        land_force=course.land_force,
        arcs=course.arcs,
    )


def step_of(trial: TrialCut, inputs: Inputs) -> LoopStep:
    """Reference of the loop: motor power as a force bound, chip load as the upper limit."""
    power = watts_from_kw(inputs.motor_power_kw)
    bound = ForceBound(
        name=LimitName.MOTOR_POWER,
        words=LimitName.MOTOR_POWER.words,
        force=force_bound(trial, power),
    )
    # The strength of a cutter of which only size and teeth are known is unknown, so there is no
    # breakage force. The overload threshold is proportional to the bound and stays.
    reference = Reference(
        workingstep=NAME,
        bounds=(bound,),
        floor=min(_rubbing(trial, inputs), 1.0),
        ceiling=1.0,
    )
    return LoopStep(
        reference=reference,
        exponent=exponent_of(trial),
        tool="trial cutter",
        diameter=trial.tool_diameter,
    )


def exponent_of(trial: TrialCut) -> float:
    """Exponent p of the force as a function of the feed, 1 − m_c."""
    return 1.0 - trial.kienzle.m_c


def _rubbing(trial: TrialCut, inputs: Inputs) -> float:
    """Override at which the mean chip is too thin for a carbide insert.

    A material without an ISO group has no insert grade, and so no such bound.
    """
    group = load_material(inputs.material).iso_group
    if not group:
        return 0.0
    grade = find_grade(ToolKind.FACEMILL, CuttingMaterial.CARBIDE, group)
    cut = trial.cut
    ratio = mean_chip_ratio(cut.engagement, cutting_edge_angle=cut.cutting_edge_angle)
    return grade.min_chip_thickness / (ratio * cut.feed_per_tooth)


def _arcs(engagement: Engagement) -> list[Engagement | None]:
    """Arcs of contact by cell; None in air.

    The edge of the workpiece, at a distance x in front of the axis of a cutter of radius R,
    limits the arc to ``π/2 ± acos(x/R)``; x falls evenly from R to 0.
    """
    arcs: list[Engagement | None] = [None]
    for cell in range(ENTRY):
        half = acos(1.0 - (cell + 0.5) / ENTRY)
        entry = max(engagement.entry_angle, pi / 2.0 - half)
        exit_ = min(engagement.exit_angle, pi / 2.0 + half)
        # On one side of the cutter, contact begins later.
        is_met = exit_ > entry
        arcs.append(Engagement(entry_angle=entry, exit_angle=exit_) if is_met else None)
    return [*arcs, engagement]


def _engaged_width(cut: MillingCut) -> float:
    """Engaged length of all cutting edges, mean over a revolution, in mm."""
    return cut.axial_depth * cut.teeth * cut.engagement.contact_angle / (2.0 * pi)


def _peak(trial: TrialCut, arc: Engagement | None) -> float:
    """Ratio of the largest force in a revolution to the mean force."""
    if arc is None:
        return 1.0
    teeth = EngagedTeeth(
        number=trial.cut.teeth,
        entry_angle=arc.entry_angle,
        exit_angle=arc.exit_angle,
        exponent=exponent_of(trial),
    )
    return peak_over_mean(teeth)


def _single(values: Floats | float, count: int) -> Singles:
    return np.broadcast_to(np.asarray(values, dtype=np.float32), (count,)).copy()
