"""What stands in the chuck and what the part is, as radii over the spindle axis."""

from dataclasses import dataclass

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.operations import MachiningOperation
from stepnc_model.entities.turning import TurningMachiningOperation
from stepnc_model.errors import Finding
from stepnc_model.part21.values import Ref
from stepnc_model.toolpath.job import Job
from stepnc_model.toolpath.turning.outline import Outline
from stepnc_model.toolpath.turning.plane import HalfPlane
from stepnc_model.toolpath.turning.profile import Profile, highest, lowest


@dataclass(frozen=True, slots=True, kw_only=True)
class Bar:
    """What stands in the chuck, as profiles of radii over z."""

    raw: Profile
    """before the program"""
    left: Profile
    """before the workingstep"""
    part: Profile
    """after the program, as far as its features can be read"""
    findings: tuple[Finding, ...] = ()

    @property
    def radius(self) -> float:
        """Outside radius of the raw bar, mm."""
        return self.raw.top(self.raw.low, self.raw.high)


def surface_of(outlines: tuple[Outline, ...], plane: HalfPlane) -> Profile:
    """Surface that features leave, seen from outside; the deeper one where they overlap."""
    surfaces = [highest(plane.seen(outline.pieces)) for outline in outlines]
    return lowest([piece for surface in surfaces for piece in surface.pieces])


def allowance_of(job: Job, ref: Ref[Entity], operation: MachiningOperation) -> float:
    """Material that an operation leaves on the feature, mm."""
    allowance = getattr(operation, "allowance", None) or 0.0
    if not 0.0 <= allowance < 1e3:
        message = f"an allowance of {allowance:g} mm: it must not be negative"
        raise job.fault(message, ref, "allowance")
    return float(allowance)


def operation_of(job: Job) -> TurningMachiningOperation:
    """The operation of a turning workingstep."""
    operation = job.step.operation
    if not isinstance(operation, TurningMachiningOperation):
        raise job.fault("is no operation of a lathe", job.step.operation_ref)
    return operation
