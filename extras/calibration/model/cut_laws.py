"""Laws that a table of cuts teaches: cutting force, roughness Ra and tool life, with priors.

``ln k_c = ln k₀ − m·ln(h/h₀)`` at h₀ = 0.2 mm, because k_c1.1 is an extrapolation whose error
goes with that of m; tool, chip breaker, edge and coolant move k₀ and m a little.
Ra has the law of :mod:`simulator.physics.surface_spread`.
``ln T = ln T₀ − (1/n)·ln(v/v₀) − x·ln(f/f₀) − y·ln(a/a₀)``.

References
----------
.. [1] O. Kienzle, VDI-Z 94, 1952: k_c = k_c1.1·h^−m_c. Priors of k₀ and m: spread over 34
   materials and between catalogues (Mitsubishi Materials, cutting power).
.. [2] ISO 3685: tool life in turning. Priors of x and y are customary.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from math import acos, cos, log, sin
from typing import Protocol

import numpy as np

from extras.calibration.model.cut_table import CutRow
from extras.calibration.model.log_model import Curve, Prior, Readings
from simulator.motion.segments import Floats
from simulator.physics.surface import RA_FLOOR, corner_coefficient
from simulator.physics.surface_spread import (
    HELD_SPEED,
    REFERENCE_SPEED,
    unmeasured_spread,
)
from simulator.spec import Taylor, WorkMaterial
from simulator.surface_law import NAMES
from stepnc_model.units import m_min_from_speed, rad_from_deg, um_from_mm

REFERENCE_CHIP = 0.2  # mm
REFERENCE_FEED = 0.2  # mm, of tool life
REFERENCE_DEPTH = 2.0  # mm, of tool life and of forces whose depth is not known

SPREAD_OF_CATALOGUE = 0.30  # sd of ln k₀; catalogues differ by 20 to 70 % for one steel
SPREAD_OF_HARDENED = 0.6  # sd of ln k₀ in ISO group H, whose m_c is a guess
EXPONENT = {True: (0.23, 0.05), False: (0.20, 0.08)}  # m, turning and milling
BETWEEN_TOOLS = (0.08, 0.05)  # sd of ln k₀ and of m between chip breakers on one steel
FORCE_SCATTER, LIFE_SCATTER = 0.03, 0.35  # sd of ln of one reading
GROWTH = 0.05  # sd of ln k_c for each e-fold of h outside the measured range
WEAR_FORCE = (500.0, 300.0)  # N/mm², force over the worn land
UNKNOWN_DEPTH = 1.0  # sd of ln a_p where a table gives none
RA_WEAR = (2.0, 0.5)  # of Ra for each mm of flank wear, and its relative sd
LIFE_LEVEL = 1.0  # sd of ln T₀
SLOPE = {"hss": (0.125, 0.03), "carbide": (0.25, 0.05), "ceramic": (0.6, 0.1)}  # n
LIFE_FEED, LIFE_DEPTH = (0.8, 0.3), (0.3, 0.2)  # x, y


class LawKind(StrEnum):
    """What a law predicts."""

    FORCES = "forces"
    ROUGHNESS = "roughness"
    LIFE = "life"


class Law(Protocol):
    """Law of one quantity, as rows of a table know it."""

    @property
    def quantity(self) -> LawKind:
        """What it predicts."""

    @property
    def prior(self) -> Prior:
        """Its parameters before any row."""

    def readings(self, rows: Sequence[CutRow]) -> Readings:
        """Logarithms of the measured values of rows."""

    def curve(self, rows: Sequence[CutRow]) -> Curve:
        """Predicted logarithms of rows as a function of the parameters."""

    def extra(self, rows: Sequence[CutRow], fitted: Sequence[CutRow]) -> Floats:
        """Standard deviation that the distance from the fitted rows adds."""

    def baselines(
        self, rows: Sequence[CutRow], fitted: Sequence[CutRow]
    ) -> Mapping[str, Floats]:
        """Predictions of simpler rules, which know the same rows."""


def _column(rows: Sequence[CutRow], name: str, unknown: float) -> Floats:
    values = [row.number(name) for row in rows]
    return np.array([unknown if each is None else each for each in values], dtype=float)


def chip(row: CutRow) -> tuple[float, float]:
    """Chip thickness h and width b, mm; along the nose h is the mean A/b.

    A row without depth has the width of the reference depth.
    """
    feed, depth = row.numbers["feed_mm"], row.number("axial_depth_mm") or REFERENCE_DEPTH
    angle = rad_from_deg(row.number("cutting_edge_angle_deg") or 90.0)
    nose = row.number("nose_radius_mm")
    if nose is None or row.number("axial_depth_mm") is None:
        return feed * sin(angle), depth / sin(angle)
    straight = depth - nose * (1.0 - cos(angle))
    if straight > 0.0:
        length = nose * angle + straight / sin(angle)
    else:
        length = nose * acos(1.0 - depth / nose)
    return feed * depth / length, length


@dataclass(frozen=True, slots=True, kw_only=True)
class CutForceLaw:
    """Cutting force, N, or specific cutting force, N/mm², of rows."""

    material: WorkMaterial
    keys: tuple[str, ...]
    """Levels of tool and conditions that were fitted; one alone is the material's own."""
    is_turned: bool
    quantity: LawKind = field(default=LawKind.FORCES, init=False)

    @property
    def levels(self) -> tuple[str, ...]:
        """Keys with parameters of their own."""
        return self.keys if len(self.keys) > 1 else ()

    @property
    def prior(self) -> Prior:
        """Catalogue at h₀, customary exponent."""
        kienzle = self.material.kienzle
        level = log(kienzle.k_c11) - kienzle.m_c * log(REFERENCE_CHIP)
        hard = self.material.iso_group == "H"
        exponent, its_sd = EXPONENT[self.is_turned]
        names = ["ln k0", "m", "wear", "ln depth"]
        mean = [level, exponent, 0.0, 0.0]
        sd = [SPREAD_OF_HARDENED if hard else SPREAD_OF_CATALOGUE, its_sd, 1.0, UNKNOWN_DEPTH]
        for key in self.levels:
            names += [f"ln k0 of {key}", f"m of {key}"]
            mean += [0.0, 0.0]
            sd += BETWEEN_TOOLS
        return Prior(
            names=tuple(names), mean=np.array(mean), sd=np.array(sd), sigma=FORCE_SCATTER,
            degrees=4.0,
        )  # fmt: skip

    def readings(self, rows: Sequence[CutRow]) -> Readings:
        """Logarithm of the force, or of k_c where a row gives that."""
        value = [
            log(row.number("specific_cutting_force_n_mm2") or row.numbers["cutting_force_n"])
            for row in rows
        ]
        return Readings(value=np.array(value), is_bound=np.zeros(len(rows)))

    def curve(self, rows: Sequence[CutRow]) -> Curve:
        """Kienzle's law with levels, wear, and an unknown depth."""
        h, b = np.array([chip(row) for row in rows]).reshape(-1, 2).T
        is_force = np.array([
            row.number("specific_cutting_force_n_mm2") is None for row in rows
        ])
        unknown = is_force & np.array([row.number("axial_depth_mm") is None for row in rows])
        wear = _column(rows, "flank_wear_mm", 0.0)
        away = np.log(h / REFERENCE_CHIP)
        slope = np.zeros((len(rows), 4 + 2 * len(self.levels)))
        slope[:, 0], slope[:, 1], slope[:, 3] = 1.0, -away, unknown
        for place, row in enumerate(rows):
            if row.key in self.levels:
                first = 4 + 2 * self.levels.index(row.key)
                slope[place, first : first + 2] = 1.0, -away[place]
        offset = np.where(is_force, np.log(b * h), 0.0)

        def at(theta: Floats) -> tuple[Floats, Floats]:
            specific = np.exp(
                slope[:, [0, 1, *range(4, slope.shape[1])]] @ np.delete(theta, [2, 3])
            )
            worn = max(WEAR_FORCE[0] + WEAR_FORCE[1] * theta[2], 0.0)
            share = worn * wear / (h * specific)
            found = slope / (1.0 + share)[:, None]
            found[:, 3] = slope[:, 3]
            found[:, 2] = WEAR_FORCE[1] * wear / (h * specific) / (1.0 + share)
            sharp = np.log(specific) + offset + slope[:, 3] * theta[3]
            return sharp + np.log1p(share), found

        return at

    def extra(self, rows: Sequence[CutRow], fitted: Sequence[CutRow]) -> Floats:
        """Growth outside the measured chips, and tools that were not measured."""
        h = np.array([chip(row)[0] for row in rows])
        grown = np.zeros(len(rows))
        if fitted:
            seen = [chip(row)[0] for row in fitted]
            outside = np.log(np.maximum(h / max(seen), 1.0) * np.maximum(min(seen) / h, 1.0))
            grown = GROWTH * outside
        away = np.log(h / REFERENCE_CHIP)
        new = np.array([bool(self.keys) and row.key not in self.keys for row in rows])
        between = new * np.hypot(BETWEEN_TOOLS[0], BETWEEN_TOOLS[1] * away)
        found: Floats = np.hypot(grown, between)
        return found

    def baselines(
        self, rows: Sequence[CutRow], fitted: Sequence[CutRow]
    ) -> Mapping[str, Floats]:
        """The catalogue, one factor on it, and the mean k_c of the fitted rows."""
        kienzle = self.material.kienzle

        def catalogue(each: Sequence[CutRow], exponent: float) -> Floats:
            h, b = np.array([chip(row) for row in each]).reshape(-1, 2).T
            given = [row.number("specific_cutting_force_n_mm2") is not None for row in each]
            area: Floats = np.where(given, 0.0, np.log(b * h))
            found: Floats = area + log(kienzle.k_c11) - exponent * np.log(h)
            return found

        found = {"catalogue": catalogue(rows, kienzle.m_c)}
        if fitted:
            measured = self.readings(fitted).value
            for name, exponent in (("factor", kienzle.m_c), ("constant k_c", 0.0)):
                factor = np.mean(measured - catalogue(fitted, exponent))
                found[name] = catalogue(rows, exponent) + factor
        return found


@dataclass(frozen=True, slots=True, kw_only=True)
class RoughnessLaw:
    """Roughness Ra, µm, of rows."""

    material: WorkMaterial
    quantity: LawKind = field(default=LawKind.ROUGHNESS, init=False)

    @property
    def prior(self) -> Prior:
        """A shop that was not measured."""
        known = unmeasured_spread(self.material.iso_group)
        return Prior(
            names=NAMES,
            mean=np.array(known.mean),
            sd=np.sqrt(np.diag(known.covariance)),
            sigma=known.sigma,
            degrees=known.degrees,
        )

    def readings(self, rows: Sequence[CutRow]) -> Readings:
        """Logarithm of Ra."""
        value = np.log([row.numbers["ra_um"] for row in rows])
        return Readings(value=value, is_bound=np.zeros(len(rows)))

    def curve(self, rows: Sequence[CutRow]) -> Curve:
        """Ideal roughness and a floor."""
        ideal = _ideal(rows)
        low, high = HELD_SPEED
        speed = _column(rows, "cutting_speed_m_min", REFERENCE_SPEED)
        fast = np.log(np.clip(speed, low, high) / REFERENCE_SPEED)
        dry = np.array([float(row.is_dry) for row in rows])
        wear = _column(rows, "flank_wear_mm", 0.0)
        teeth = _column(rows, "teeth", 1.0)
        high_tooth = np.where([row.is_turned for row in rows], 0.0, 2.0 * np.log(teeth))

        def at(theta: Floats) -> tuple[Floats, Floats]:
            trace = ideal * np.exp(theta[0] + theta[5] * high_tooth)
            floor = np.exp(theta[1] - theta[2] * fast + theta[3] * dry)
            share = trace / (trace + floor)
            growth = RA_WEAR[0] * wear
            worn = np.maximum(1.0 + growth * (1.0 + RA_WEAR[1] * theta[4]), 0.2)
            rest = 1.0 - share
            slope = np.column_stack((
                share, rest, -rest * fast, rest * dry, growth * RA_WEAR[1] / worn,
                share * high_tooth,
            ))  # fmt: skip
            return np.log(trace + floor) + np.log(worn), slope

        return at

    def extra(self, rows: Sequence[CutRow], fitted: Sequence[CutRow]) -> Floats:
        """Nothing: the wide prior widens the answer by itself."""
        return np.zeros(len(rows))

    def baselines(
        self, rows: Sequence[CutRow], fitted: Sequence[CutRow]
    ) -> Mapping[str, Floats]:
        """The ideal with its customary floor, and the mean of the fitted rows."""
        found = {"ideal + 0.2 µm": np.log(_ideal(rows) + um_from_mm(RA_FLOOR))}
        if fitted:
            mean = float(np.mean(self.readings(fitted).value))
            found["mean Ra"] = np.full(len(rows), mean)
        return found


def _ideal(rows: Sequence[CutRow]) -> Floats:
    """Ideal Ra, µm, of the feed per revolution or per tooth and the nose."""
    return np.array([
        um_from_mm(
            corner_coefficient(row.numbers["nose_radius_mm"]) * row.numbers["feed_mm"] ** 2
        )
        for row in rows
    ])


@dataclass(frozen=True, slots=True, kw_only=True)
class LifeLaw:
    """Tool life, min, of edges; each edge is one row."""

    taylor: Taylor
    edge_material: str
    speed: float
    """Reference speed, m/min: fixed by the material, so that batches agree."""
    quantity: LawKind = field(default=LawKind.LIFE, init=False)

    @property
    def prior(self) -> Prior:
        """Taylor's law of the catalogue."""
        level = log(m_min_from_speed(self.taylor.constant) / self.speed) / self.taylor.exponent
        exponent, its_sd = SLOPE[self.edge_material]
        return Prior(
            names=("ln T0", "1/n", "x", "y"),
            mean=np.array([level, 1.0 / exponent, LIFE_FEED[0], LIFE_DEPTH[0]]),
            sd=np.array([LIFE_LEVEL, its_sd / exponent**2, LIFE_FEED[1], LIFE_DEPTH[1]]),
            sigma=LIFE_SCATTER,
            degrees=4.0,
        )

    def readings(self, rows: Sequence[CutRow]) -> Readings:
        """Logarithm of the life, or of the time at which an edge stopped unworn."""
        value = [log(row.number("life_min") or row.numbers["time_min"]) for row in rows]
        bound = [float(row.number("life_min") is None) for row in rows]
        return Readings(value=np.array(value), is_bound=np.array(bound))

    def curve(self, rows: Sequence[CutRow]) -> Curve:
        """Straight line in logarithms."""
        slope = np.column_stack((
            np.ones(len(rows)),
            -np.log(_column(rows, "cutting_speed_m_min", self.speed) / self.speed),
            -np.log(_column(rows, "feed_mm", REFERENCE_FEED) / REFERENCE_FEED),
            -np.log(_column(rows, "axial_depth_mm", REFERENCE_DEPTH) / REFERENCE_DEPTH),
        ))
        return lambda theta: (slope @ theta, slope)

    def extra(self, rows: Sequence[CutRow], fitted: Sequence[CutRow]) -> Floats:
        """Nothing: exponents that were not seen widen the answer by themselves."""
        return np.zeros(len(rows))

    def baselines(
        self, rows: Sequence[CutRow], fitted: Sequence[CutRow]
    ) -> Mapping[str, Floats]:
        """Taylor's law of the catalogue, and the mean of the fitted lives."""
        theta = self.prior.mean.copy()
        theta[2:] = 0.0
        found = {"catalogue": self.curve(rows)(theta)[0]}
        if fitted:
            mean = float(np.mean(self.readings(fitted).value))
            found["mean life"] = np.full(len(rows), mean)
        return found
