"""What a material's file knows of the law of roughness Ra.

The law itself is in :mod:`simulator.physics.surface_spread`.
"""

from dataclasses import dataclass

NAMES = ("ln c", "ln R0", "gamma", "delta", "wear", "contact")
"""Parameters of the law, in their order."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SurfaceSpread:
    """Known parameters of the law of Ra in :mod:`simulator.physics.surface_spread`."""

    mean: tuple[float, ...]
    covariance: tuple[tuple[float, ...], ...]
    sigma: float
    degrees: float
    count: int = 0  # measured surfaces; 0: the spread between published studies
