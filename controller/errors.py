"""The controller's branch of the error tree (:mod:`stepnc_model.errors`)."""

from stepnc_model.errors import StepNcError


class ControlError(StepNcError):
    """The loop cannot do its work."""


class StaleSample(ControlError):
    """The last reading is too old to be acted upon.

    Parameters
    ----------
    age : float
        s since it was taken.
    """

    def __init__(self, age: float) -> None:
        super().__init__(f"the last force reading is {age:.3g} s old")
        self.age = age


class MachineLost(ControlError):
    """The machine does not answer any more."""
