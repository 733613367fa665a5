"""Nominal outlines of the features that a turning workingstep makes."""

from stepnc_model.entities.turning import TurningMachiningOperation
from stepnc_model.errors import SchemaError
from stepnc_model.programs.program import Program, ResolvedWorkingstep
from stepnc_model.toolpath.task import job_of
from stepnc_model.toolpath.turning.operation import outlines_of
from stepnc_model.toolpath.turning.outline import FeatureOutline


def nominal_outlines(program: Program, step: ResolvedWorkingstep) -> tuple[FeatureOutline, ...]:
    """Outlines of the features of a workingstep; none where it does not turn any."""
    if not isinstance(step.operation, TurningMachiningOperation):
        return ()
    try:
        return outlines_of(job_of(program, step))
    except SchemaError:
        # What has no outline, such as a face groove, is not compared.
        return ()
