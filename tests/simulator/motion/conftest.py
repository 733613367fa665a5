"""Paths and limits on which every control model is tried, and integration between knots."""

from collections.abc import Callable

import numpy as np
import pytest

from simulator.motion.segments import AxisLimits, Floats, Motion, Segments, arc, chained, lines

Wander = Callable[[int], Segments]
Drift = Callable[[Motion], float]


@pytest.fixture(scope="session")
def limits() -> AxisLimits:
    return AxisLimits(
        acceleration=np.array([4000.0, 3000.0, 2000.0]),
        rapid=np.array([600.0, 500.0, 400.0]),
        feed=np.array([300.0, 250.0, 200.0]),
    )


@pytest.fixture(scope="session")
def wander() -> Wander:
    """Random feeds and rapids: lines, arcs and helices in all planes, some without length."""

    def path(seed: int) -> Segments:
        random = np.random.default_rng(seed)
        parts = [lines([(3.0, 0.0, 0.0), (20.0, -8.0, 5.0)])]
        for index in range(25):
            start = parts[-1].end[-1]
            speed = float(random.choice([2.0, 30.0, 250.0, np.inf]))
            shift = random.normal(size=3) * random.choice([0.0, 0.3, 15.0])
            if random.random() < 0.5 and np.isfinite(speed):
                turn = float(random.choice([-7.0, -1.0, 0.02, 2.0]))
                centre = start + random.normal(size=3) * 5.0
                parts.append(
                    arc(
                        list(start),
                        list(centre),
                        turn,
                        normal=index % 3,
                        rise=float(shift[0]),
                        speed=speed,
                    )
                )
            else:
                parts.append(lines([start, start + shift], speed=speed))
        return chained(parts)

    return path


@pytest.fixture(scope="session")
def drift() -> Drift:
    """Greatest distance in mm of the position from the velocity integrated between knots."""
    nodes, weights = np.polynomial.legendre.leggauss(12)

    def greatest(motion: Motion) -> float:
        knots = motion.knots
        # Cut finely enough that the quadrature is exact on arcs of several turns.
        steps = np.diff(knots)
        cuts = np.unique(np.concatenate([knots[:-1] + steps * k / 16 for k in range(16)]))
        cuts = np.append(cuts, motion.duration)
        half = 0.5 * np.diff(cuts)
        times = (cuts[:-1] + half)[:, None] + half[:, None] * nodes
        velocity = motion.at(times.ravel()).velocity.reshape(len(half), len(nodes), 3)
        travelled = np.einsum("k,n,kna->ka", half, weights, velocity)
        position = motion.at(cuts).position
        gap: Floats = position[0] + np.cumsum(travelled, axis=0) - position[1:]
        return float(np.abs(gap).max())

    return greatest
