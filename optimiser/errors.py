"""Errors of the optimiser; the tree is drawn in :mod:`stepnc_model.errors`."""

from stepnc_model.errors import StepNcError


class OptimisationError(StepNcError):
    """No optimal feed could be found."""


class Infeasible(OptimisationError):
    """Limits contradict each other, or the stock to be left: no setting is feasible.

    Parameters
    ----------
    message : str
        The limits that conflict, with their numbers and units.
    limits : tuple of str
        Names of the limits that conflict; none where the stock would differ.
    station : int, optional
        Index of the station of a path where they do.
    """

    def __init__(
        self, message: str, *, limits: tuple[str, ...], station: int | None = None
    ) -> None:
        super().__init__(message)
        self.limits = limits
        self.station = station


class SolverFailed(OptimisationError):
    """The convex solver found no optimum.

    Parameters
    ----------
    status : str
        Status reported by the solver.
    program : str
        Program that was solved.
    """

    def __init__(self, status: str, *, program: str = "geometric program") -> None:
        super().__init__(f"the {program} has no solution: {status}")
        self.status = status
