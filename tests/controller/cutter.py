"""Forces of a cutter with runout or a broken tooth, as sums over chips, sample by sample.

They know nothing of the shares and hypotheses by which the loop judges them.
"""

from dataclasses import dataclass, replace
from math import pi

import numpy as np

from controller.signals.ports import Floats
from controller.signals.preview import Expected
from controller.signals.signal import Revolution
from simulator.physics.tooth_means import Arcs
from tests.controller.shown import REVOLUTION, SPINDLE_SPEED

SAMPLES = 8
EXPONENT = 0.8
FEED_PER_TOOTH = 0.1
SUNKEN = 1.0
"""mm by which a broken tooth lies below the others"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Cutter:
    teeth: int = 4
    arc: float = 0.5 * pi
    """rad of down-milling that ends at π"""
    eccentricity: float = 0.0
    """mm"""
    force: float = 400.0
    """N of one tooth at its thickest chip, f_z = 0.1 mm"""

    def forces(self, feed: float = FEED_PER_TOOTH, *, broken: int | None = None) -> Floats:
        """(z, K) N."""
        turned = 2.0 * pi / self.teeth * np.arange(self.teeth)
        runout = self.eccentricity * np.cos(turned)
        if broken is not None:
            runout[broken] -= SUNKEN
        middle = (np.arange(self.teeth * SAMPLES) + 0.5) / SAMPLES
        entry = pi - self.arc
        tip = entry + 2.0 * pi / self.teeth * middle
        angle = np.mod(tip[:, None] - turned, 2.0 * pi)
        # What the tooth before left, or the one before that, is above this one's own path.
        left = [
            before * feed * np.sin(angle) + runout - np.roll(runout, before)
            for before in range(1, self.teeth + 1)
        ]
        chip = np.min(left, axis=0).clip(min=0.0)
        in_cut = (angle >= entry) & (angle <= pi)
        force = self.force * ((chip / FEED_PER_TOOTH) ** EXPONENT * in_cut).sum(axis=1)
        return np.asarray(force.reshape(self.teeth, SAMPLES))

    @property
    def expected(self) -> Expected:
        """What the program knows: the arc, and the force of equal teeth."""
        even = np.ones(self.teeth)
        force = float(replace(self, eccentricity=0.0).forces().mean())
        arcs = Arcs(entry_angle=(pi - self.arc) * even, exit_angle=pi * even, lag=0.0 * even)
        return Expected(force=force * even, change=0.0 * even, arcs=arcs)


def shown(forces: Floats, *, feed: float = FEED_PER_TOOTH, step: int = 1) -> Revolution:
    return REVOLUTION._replace(
        force=float(forces.mean()),
        tooth_means=forces.mean(axis=1),
        tooth_peaks=forces.max(axis=1),
        tooth_feeds=np.full(len(forces), feed * len(forces) * SPINDLE_SPEED),
        tooth_overrides=np.full(len(forces), feed / FEED_PER_TOOTH),
        feed=feed * len(forces) * SPINDLE_SPEED,
        workingstep=step,
    )


def noisy(forces: Floats, random: np.random.Generator) -> Floats:
    """3 % of the reading and 1 N, as a dynamometer has them."""
    relative = 1.0 + 0.03 * random.standard_normal(forces.shape)
    return np.asarray(forces * relative + random.standard_normal(forces.shape))
