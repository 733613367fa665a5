"""Errors of the simulator; the tree is drawn in :mod:`stepnc_model.errors`."""

from stepnc_model.errors import StepNcError


class SimulationError(StepNcError):
    """The virtual machine or its library cannot do what was asked."""


class UnknownMachine(SimulationError):
    """No machine has that name.

    Parameters
    ----------
    name : str
        What was asked for.
    known : sequence of str
        Names that exist, the nearest first.
    """

    def __init__(self, name: str, known: tuple[str, ...]) -> None:
        super().__init__(f"unknown machine '{name}'; known: {', '.join(known)}")
        self.name = name
        self.known = known


class UnknownMaterial(SimulationError):
    """No material matches that name.

    Parameters
    ----------
    name : str
        What was asked for.
    near : sequence of str
        Names that come near, the nearest first.
    """

    def __init__(self, name: str, near: tuple[str, ...]) -> None:
        super().__init__(f"unknown material '{name}'; near names: {', '.join(near)}")
        self.name = name
        self.near = near


class LibraryError(SimulationError):
    """A machine, material or tool-grade file is unusable.

    Parameters
    ----------
    message : str
        The value, the bound and the unit.
    path : str
        The file.
    key : str
        The key in it, ``spindle.max_speed_rpm`` for example.
    """

    def __init__(self, message: str, *, path: str, key: str = "") -> None:
        super().__init__(f"{path}: {key + ': ' if key else ''}{message}")
        self.path = path
        self.key = key
