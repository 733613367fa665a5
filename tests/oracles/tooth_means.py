"""Means of the periods of teeth for many sets of offsets, by the kernel of one set."""

import numpy as np

from simulator.kernels.kernel import entry
from simulator.physics.tooth_means import Floats, Periods, means_of


def tooth_means(at: Periods, offsets: Floats) -> Floats:
    """Mean force in the period of each tooth, (M, z), of offsets, (M, z)."""
    means = np.empty(offsets.shape)
    _means(at, np.ascontiguousarray(offsets), means)
    return means


@entry
def _means(at: Periods, offsets: Floats, means: Floats) -> None:
    """Kernel of :func:`tooth_means`; the means are written into ``means``."""
    for row in range(offsets.shape[0]):
        means_of(at, offsets[row], means[row])
