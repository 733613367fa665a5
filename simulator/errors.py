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


class MachineSilent(SimulationError):
    """The line to the machine is broken.

    Parameters
    ----------
    time : float
        s of the run.
    """

    def __init__(self, time: float) -> None:
        super().__init__(f"the machine does not answer since {time:.2f} s")
        self.time = time


class ProgramFault(SimulationError):
    """The machine cannot run a line of the program.

    Parameters
    ----------
    message : str
    line : int
        Of the NC code or of the blocks made of the program, counted from 1.
    """

    def __init__(self, message: str, line: int) -> None:
        super().__init__(f"line {line}: {message}")
        self.line = line


class OutOfTravel(SimulationError):
    """A move leaves the travel of an axis.

    Parameters
    ----------
    axis : str
    position : float, mm
        In the program's coordinates.
    travel : (float, float), mm
        Ends of the axis there.
    line : int
        Of the program.
    """

    def __init__(
        self, axis: str, position: float, *, travel: tuple[float, float], line: int
    ) -> None:
        low, high = travel
        super().__init__(
            f"line {line}: {axis} = {position:g} mm is off the travel of the axis, "
            f"{low:g} to {high:g} mm in the program's coordinates"
        )
        self.axis = axis
        self.position = position
        self.line = line


class UnknownTool(SimulationError):
    """A tool that the program asks for is not in the table.

    Parameters
    ----------
    number : int
    known : str
        Numbers that are.
    line : int
        Of the program.
    """

    def __init__(self, number: int, known: str, line: int) -> None:
        super().__init__(f"line {line}: no tool T{number} in the table; known: {known}")
        self.number = number
        self.line = line


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
    line : int
        Line of the file, counted from 1; 0 when the key says where.
    """

    def __init__(self, message: str, *, path: str, key: str = "", line: int = 0) -> None:
        place = (path, f"line {line}" if line else "", key, message)
        super().__init__(": ".join(part for part in place if part))
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
        The value, the bound and the unit.
    path : str
        The file, empty when there is none.
    line : int
        Line of the file, counted from 1; 0 when there is none.
    column : str
        Name of the column, or empty.
    """

    def __init__(
        self, message: str, *, path: str = "", line: int = 0, column: str = ""
    ) -> None:
        place = (path, f"line {line}" if line else "", column, message)
        super().__init__(": ".join(part for part in place if part))
        self.path = path
        self.line = line
        self.column = column
