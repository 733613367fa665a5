"""Errors of the simulator; the tree is drawn in :mod:`stepnc_model.errors`."""

from collections.abc import Sequence

from stepnc_model.errors import StepNcError
from stepnc_model.units import hours_from_seconds


class SimulationError(StepNcError):
    """Base class of errors of the virtual machine and its library."""


class UnknownMachine(SimulationError):
    """No machine has the given name.

    Parameters
    ----------
    name : str
        Requested name.
    known : sequence of str
        Existing names, the most similar first.
    """

    def __init__(self, name: str, known: tuple[str, ...]) -> None:
        super().__init__(f"unknown machine '{name}'; known: {', '.join(known)}")
        self.name = name
        self.known = known


class MachineSilent(SimulationError):
    """The connection to the machine is lost.

    Parameters
    ----------
    time : float
        Time of the run, in s.
    """

    def __init__(self, time: float) -> None:
        super().__init__(f"the machine has not answered since {time:.2f} s")
        self.time = time


class ProgramFault(SimulationError):
    """The machine cannot run a line of the program.

    Parameters
    ----------
    line : int
        Line of the NC code, or of the blocks generated from the program, counted from 1.
    """

    def __init__(self, message: str, line: int) -> None:
        super().__init__(f"line {line}: {message}")
        self.line = line


class OutOfTravel(SimulationError):
    """A move leaves the travel of an axis.

    Parameters
    ----------
    position : float, mm
        Position in the program's coordinates.
    travel : (float, float), mm
        Limits of the axis in the program's coordinates.
    line : int
        Line of the program.
    """

    def __init__(
        self, axis: str, position: float, *, travel: tuple[float, float], line: int
    ) -> None:
        low, high = travel
        super().__init__(
            f"line {line}: {axis} = {position:g} mm is outside the travel of the axis, "
            f"{low:g} to {high:g} mm in the program's coordinates"
        )
        self.axis = axis
        self.position = position
        self.line = line


class UnknownTool(SimulationError):
    """A tool that the program calls is not in the tool table.

    Parameters
    ----------
    number : int
    known : str
        Numbers of the tools in the table.
    line : int
        Line of the program.
    """

    def __init__(self, number: int, known: str, line: int) -> None:
        super().__init__(f"line {line}: tool T{number} is not in the table; known: {known}")
        self.number = number
        self.line = line


class UnknownMaterial(SimulationError):
    """No material matches the given name.

    Parameters
    ----------
    name : str
        Requested name.
    near : sequence of str
        Similar names, the most similar first.
    """

    def __init__(self, name: str, near: tuple[str, ...]) -> None:
        super().__init__(f"unknown material '{name}'; similar names: {', '.join(near)}")
        self.name = name
        self.near = near


class LibraryError(SimulationError):
    """A file of a machine, material or tool grade is not usable.

    Parameters
    ----------
    message : str
        Value, bound and unit.
    path : str
        Path of the file.
    key : str
        Key in the file, for example ``spindle.max_speed_rpm``.
    line : int
        Line of the file, counted from 1; 0 if the key gives the place.
    """

    def __init__(self, message: str, *, path: str, key: str = "", line: int = 0) -> None:
        place = (path, f"line {line}" if line else "", key, message)
        super().__init__(": ".join(part for part in place if part))
        self.message = message
        self.path = path
        self.key = key
        self.line = line


class AgentError(SimulationError):
    """A device model, a document or an adapter of MTConnect cannot be used."""


class CalibrationError(SimulationError):
    """A measured run cannot be used, or a model cannot be fitted to it.

    Parameters
    ----------
    message : str
        Value, bound and unit.
    path : str
        Path of the file; empty if there is none.
    line : int
        Line of the file, counted from 1; 0 if there is none.
    column : str
        Name of the column; empty if there is none.
    """

    def __init__(
        self, message: str, *, path: str = "", line: int = 0, column: str = ""
    ) -> None:
        place = (path, f"line {line}" if line else "", column, message)
        super().__init__(": ".join(part for part in place if part))
        self.path = path
        self.line = line
        self.column = column


class Deadlock(SimulationError):
    """Machines of a shop wait for each other without end.

    Parameters
    ----------
    waits : sequence of str
        Sentence for each machine: what it holds and what it waits for.
    time : float
        Time of the run, in s.
    """

    def __init__(self, waits: Sequence[str], time: float) -> None:
        super().__init__(
            f"deadlock after {hours_from_seconds(time):.2f} h: {'; '.join(waits)}; "
            "enlarge a buffer"
        )
        self.waits = tuple(waits)
        self.time = time

    def __reduce__(self) -> tuple[type["Deadlock"], tuple[tuple[str, ...], float]]:
        """Arguments for pickling, from a worker process."""
        return Deadlock, (self.waits, self.time)
