"""Cutting model of a trial cut: from the user's inputs to the data of machine and loop.

A cutter enters an endless workpiece. While it enters, the arc of contact opens about the feed
direction, as the edge of the workpiece moves from the front of the cutter towards its axis;
then the engagement is constant. The real entry length is half a diameter; here entry takes a
fixed number of revolutions, so that large cutters do not need minutes. All forces come from
:mod:`simulator.physics`, with the library's k_c, uncorrected for a tool.

Units mm, s, N, W, rad, rev/s.

References
----------
.. [1] F. Ridwan, X. Xu, G. Liu, "A framework for machining optimisation based on STEP-NC",
   J. Intell. Manuf., 2010, eqs. (1) to (6).
"""

from dataclasses import dataclass, replace
from math import acos, pi

import numpy as np

from controller.loop_settings import LoopStep
from controller.preview import Preview
from controller.reference import ForceBound, Reference
from optimiser.problem import LimitName
from service.trial.inputs import Inputs, MillingType
from simulator.library import find_grade, load_material
from simulator.motion.segments import Floats
from simulator.physics import flank, kinematics
from simulator.physics.engagement import (
    Engagement,
    bilateral,
    conventional,
    full_immersion,
    mean_chip_ratio,
    unidirectional,
)
from simulator.physics.milling import MillingCut, mean_force, mean_specific_force
from simulator.physics.power import cutting_power, motor_power
from simulator.plant.course import EngagedTeeth, NominalCourse, Singles, peak_over_mean
from simulator.spec import CuttingMaterial, Kienzle, ToolKind
from stepnc_model.units import rad_from_deg, speed_from_m_min, watts_from_kw

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
    """Closed-form results at a feed; the governing equations of [1]_."""

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
