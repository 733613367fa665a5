"""The controller's branch of the error tree (:mod:`stepnc_model.errors`)."""

from stepnc_model.errors import StepNcError


class ControlError(StepNcError):
    """The loop cannot do its work."""


class MachineLost(ControlError):
    """The machine does not answer any more."""
