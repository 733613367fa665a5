"""TOPP-RA by its authors, for the same problem."""

import warnings

import numpy as np

from optimiser.feed_profile.profile import AxisLimit, Floats, ProfileProblem

with warnings.catch_warnings():
    warnings.simplefilter("ignore")  # of escape sequences in its docstrings
    from toppra import algorithm, constraint
    from toppra.interpolator import AbstractGeometricPath


class TabulatedPath(AbstractGeometricPath):  # type: ignore[misc]
    """Path whose derivatives are known at the stations, where alone they are asked for."""

    def __init__(self, stations: Floats, tangent: Floats, curvature: Floats) -> None:
        self._stations = stations
        self._derivatives = (np.zeros_like(tangent), tangent, curvature)

    def __call__(self, _: Floats, order: int = 0) -> Floats:
        """Position or derivative at all stations."""
        return self._derivatives[order]

    @property
    def dof(self) -> int:
        """Number of axes."""
        return 3

    @property
    def path_interval(self) -> Floats:
        """First and last station."""
        return self._stations[[0, -1]]

    @property
    def waypoints(self) -> None:
        """No waypoints."""
        return None


class Caps(constraint.LinearConstraint):  # type: ignore[misc]
    """Caps on b at the stations."""

    def __init__(self, caps: Floats) -> None:
        super().__init__()
        self._bounds = np.stack((np.zeros(len(caps)), caps), axis=1)

    def compute_constraint_params(self, *_: object) -> tuple[object, ...]:
        """Bounds on b alone."""
        return None, None, None, None, None, None, self._bounds

    def get_dof(self) -> int:
        """Number of axes."""
        return 3


def toppra_squares(problem: ProfileProblem, limit: AxisLimit) -> Floats:
    """Squared feeds from rest to rest; the path must have no jumps of curvature."""
    tangent = np.vstack((limit.start_tangent, limit.end_tangent[-1:]))
    curvature = np.vstack((limit.start_curvature, limit.end_curvature[-1:]))
    path = TabulatedPath(problem.stations, tangent, curvature)
    bounds = np.stack((-limit.acceleration, limit.acceleration), axis=1)
    axes = constraint.JointAccelerationConstraint(bounds)
    solver = algorithm.TOPPRA(
        [Caps(problem.caps), axes],
        path,
        gridpoints=problem.stations,
        solver_wrapper="seidel",
    )
    _, feeds, _ = solver.compute_parameterization(0.0, 0.0)
    squares: Floats = feeds**2
    return squares


def toppra_time(problem: ProfileProblem, limit: AxisLimit) -> float:
    """Time of the whole path, s."""
    feeds = np.sqrt(toppra_squares(problem, limit))
    return float(np.sum(2.0 * problem.lengths / (feeds[1:] + feeds[:-1])))
