"""Errors of the controller; the tree is drawn in :mod:`stepnc_model.errors`."""

from stepnc_model.errors import StepNcError


class ControlError(StepNcError):
    """The control loop cannot continue."""


class MachineLost(ControlError):
    """The machine no longer responds."""
