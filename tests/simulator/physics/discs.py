"""Forces of a helical cutter summed over thin discs: slow, plain, and nobody else's code."""

from dataclasses import dataclass
from math import acos, pi, sin, tan

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

RADIAL = 0.3


@dataclass(frozen=True, slots=True, kw_only=True)
class Mill:
    """One cutter in one cut; mm, rad."""

    teeth: int
    diameter: float
    helix: float
    entry: float
    exit: float
    depth: float
    exponent: float
    corner: float = 0.0

    @property
    def pitch(self) -> float:
        return 2.0 * pi / self.teeth

    def discs(self) -> int:
        """So many that each turns by less than 1/400 of the arc, 2000 at least."""
        lag = 2.0 * self.depth * tan(self.helix) / self.diameter
        return max(2000, int(400.0 * lag / (self.exit - self.entry)))

    def forces(self, rotation: Floats) -> tuple[Floats, Floats, Floats]:
        """Tangential, against the feed, and towards φ = 0, over K·k_c1.1·f_z^q, mm."""
        count = self.discs()
        height = (np.arange(count) + 0.5) * self.depth / count
        slope = np.array([self._slope(each) for each in height.tolist()])
        width = self.depth / count * slope ** (self.exponent - 1.0)
        totals = np.zeros((3, len(rotation)))
        for tooth in range(self.teeth):
            tip = rotation[:, None] - tooth * self.pitch
            angle = np.mod(tip - 2.0 * height * tan(self.helix) / self.diameter, 2.0 * pi)
            in_cut = (angle >= self.entry) & (angle <= self.exit)
            chip = np.where(in_cut, np.sin(angle), 0.0).clip(min=0.0)
            tangential = np.where(in_cut, chip**self.exponent, 0.0) * width
            radial = RADIAL * slope * tangential
            totals[0] += tangential.sum(axis=1)
            totals[1] += (tangential * np.cos(angle) + radial * np.sin(angle)).sum(axis=1)
            totals[2] += (tangential * np.sin(angle) - radial * np.cos(angle)).sum(axis=1)
        return totals[0], totals[1], totals[2]

    def peak(self) -> float:
        """Greatest force across the axis: every 1/200 of a pitch, then finer about the best."""
        step = self.pitch / 200.0
        # The best of a jagged curve lies where a tooth enters or leaves.
        ends = np.array([self.entry, self.exit])
        lag = 2.0 * self.depth * tan(self.helix) / self.diameter
        ends = np.concatenate((ends, ends + lag))
        near = np.concatenate([ends + side for side in (-1e-9, 0.0, 1e-9)])
        rotation = np.concatenate((step * np.arange(200), near))
        _, feed, normal = self.forces(rotation)
        found = np.hypot(feed, normal)
        best = rotation[int(found.argmax())]
        _, feed, normal = self.forces(best + step * np.linspace(-1.0, 1.0, 41))
        return float(max(found.max(), np.hypot(feed, normal).max()))

    def wall(self, angle: float) -> float:
        """Greatest normal force while one height after the other passes φ = 0 or π."""
        height = np.linspace(0.0, self.depth, 401)
        rotation = angle + 2.0 * height * tan(self.helix) / self.diameter
        return float(np.abs(self.forces(rotation)[2]).max())

    def _slope(self, height: float) -> float:
        """sin κ of the edge at a height."""
        if height >= self.corner:
            return 1.0
        return sin(acos(1.0 - height / self.corner))
