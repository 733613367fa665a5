"""A work material from its TOML file.

Ranges are those of metals that are cut; a number outside is a slip of the unit. Alternative
coefficients k_c1.1 of other catalogues are kept in the files and checked, but not loaded: they
show how far sources differ, 20 to 70 % for the same steel. Pairs of feed and back force are
loaded from there, as no other source has them; else a share that was measured, else the usual
shares of :mod:`simulator.physics.turning`.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from simulator.files.toml_file import (
    FileTable,
    KeyFault,
    TableHead,
    quantity,
    read_toml,
    require_together,
    require_window,
)
from simulator.physics.turning import BACK_SHARE, FEED_SHARE
from simulator.spec import (
    CuttingMaterial,
    CuttingWindow,
    Kienzle,
    LinearEdge,
    Taylor,
    ToolConstruction,
    WorkMaterial,
)
from simulator.surface_law import NAMES, SurfaceSpread
from stepnc_model.units import rad_from_deg, speed_from_m_min

IsoGroup = Literal["P", "M", "K", "N", "S", "H", ""]
"""ISO 513 group of a work material; empty: it has none"""

Hardness = Annotated[float, quantity(10, 800, "HB")]
Density = Annotated[float, quantity(0.5, 25, "g/cm³")]
Strength = Annotated[float, quantity(10, 4_000, "N/mm²")]
SpecificForce = Annotated[float, quantity(50, 10_000, "N/mm²")]
KienzleExponent = Annotated[float, quantity(0, 0.9)]
Rake = Annotated[float, quantity(-30, 45, "°")]
ForceExponent = Annotated[float, quantity(-0.5, 1)]
Share = Annotated[float, quantity(0.01, 3)]
Spread = Annotated[float, quantity(0, 2)]
ShearCoefficient = Annotated[float, quantity(0, 10_000, "N/mm²")]
EdgeCoefficient = Annotated[float, quantity(0, 500, "N/mm")]
CuttingSpeed = Annotated[float, quantity(0.1, 10_000, "m/min")]
TaylorExponent = Annotated[float, quantity(0.01, 0.99)]
FeedRatio = Annotated[float, quantity(1e-5, 0.1)]
FeedPerTooth = Annotated[float, quantity(1e-4, 5, "mm")]
Modulus = Annotated[float, quantity(1_000, 1_000_000, "N/mm²")]

USUAL_SPREAD = {"P": 0.20, "M": 0.20, "K": 0.20, "N": 0.20, "S": 0.25, "H": 0.25, "": 0.25}
"""of k_c by ISO group where a file names none: as in the library, where its source stands; the
widest without a group"""

LEAST_MODULUS = {
    "P": 2.0e5,
    "M": 1.9e5,
    "K": 0.88e5,
    "N": 0.69e5,
    "S": 1.03e5,
    "H": 2.0e5,
    "": 0.69e5,
}
"""Young's modulus by ISO group where a file gives none, N/mm², of what bends most in it: carbon
and stainless steel, aluminium and titanium (Machinery's Handbook, 29th ed., mechanical
properties), grey iron GJL-200 (EN 1561, annex); the least without a group"""


class KienzleTable(FileTable, frozen=True, kw_only=True):
    """Kienzle's law of a table."""

    k_c11_n_mm2: SpecificForce
    m_c: KienzleExponent
    rake_angle_deg: Rake | None = None
    source: str

    @property
    def kienzle(self) -> Kienzle:
        """Law of the cutting force."""
        rake = self.rake_angle_deg
        return Kienzle(
            k_c11=self.k_c11_n_mm2,
            m_c=self.m_c,
            rake_angle=None if rake is None else rad_from_deg(rake),
        )


class OwnKienzleTable(KienzleTable, frozen=True, kw_only=True):
    """The ``[kienzle]`` table, whose law is loaded, with the spread of k_c."""

    spread: Spread | None = None
    spread_source: str | None = None

    def __post_init__(self) -> None:
        require_together(self, "spread", "spread_source")


class KienzleAlternative(KienzleTable, frozen=True, kw_only=True):
    """One ``[[kienzle_alternative]]`` row: Kienzle's law of another source.

    Where it has pairs of feed and back force, those are loaded.
    """

    k_f11_n_mm2: SpecificForce | None = None
    one_minus_m_f: ForceExponent | None = None
    k_p11_n_mm2: SpecificForce | None = None
    one_minus_m_p: ForceExponent | None = None

    def __post_init__(self) -> None:
        require_together(self, "k_f11_n_mm2", "one_minus_m_f", "k_p11_n_mm2", "one_minus_m_p")


class LinearEdgeTable(FileTable, frozen=True, kw_only=True):
    """Linear-edge model; radial and axial parts may be absent."""

    k_tc_n_mm2: ShearCoefficient
    k_te_n_mm: EdgeCoefficient
    k_rc_n_mm2: ShearCoefficient = 0.0
    k_re_n_mm: EdgeCoefficient = 0.0
    k_ac_n_mm2: ShearCoefficient = 0.0
    k_ae_n_mm: EdgeCoefficient = 0.0
    source: str

    @property
    def linear_edge(self) -> LinearEdge:
        """Coefficients by component."""
        return LinearEdge(
            k_tc=self.k_tc_n_mm2,
            k_te=self.k_te_n_mm,
            k_rc=self.k_rc_n_mm2,
            k_re=self.k_re_n_mm,
            k_ac=self.k_ac_n_mm2,
            k_ae=self.k_ae_n_mm,
        )


class SpeedWindow(FileTable, frozen=True, kw_only=True):
    """Least and greatest cutting speed of a row."""

    min_cutting_speed_m_min: CuttingSpeed | None = None
    max_cutting_speed_m_min: CuttingSpeed | None = None

    def __post_init__(self) -> None:
        require_window(self, "min_cutting_speed_m_min", "max_cutting_speed_m_min")

    @property
    def speeds(self) -> tuple[float | None, float | None]:
        """Least and greatest cutting speed in mm/s."""
        low, high = self.min_cutting_speed_m_min, self.max_cutting_speed_m_min
        return (
            None if low is None else speed_from_m_min(low),
            None if high is None else speed_from_m_min(high),
        )


class WindowRow(SpeedWindow, frozen=True, kw_only=True):
    """One ``[[window]]`` row: cutting speeds of a cutting material."""

    cutting_material: CuttingMaterial
    tool_body: ToolConstruction | None = None
    source: str


class ToolLifeRow(FileTable, frozen=True, kw_only=True):
    """One ``[[tool_life]]`` row: Taylor's constants of a cutting material."""

    cutting_material: CuttingMaterial
    exponent: TaylorExponent
    constant_m_min: CuttingSpeed
    source: str
    feed_exponent: Annotated[float, quantity(0.0, 10.0)] = 0.8
    depth_exponent: Annotated[float, quantity(0.0, 10.0)] = 0.3
    feed_mm: Annotated[float, quantity(1e-4, 100.0)] = 0.2
    depth_mm: Annotated[float, quantity(1e-3, 1e3)] = 2.0


class FeedTable(FileTable, frozen=True, kw_only=True):
    """The ``[feed_per_tooth]`` table: over the diameter, and the greatest in mm."""

    min_ratio: FeedRatio | None = None
    max_ratio: FeedRatio | None = None
    max_mm: FeedPerTooth | None = None
    source: str

    def __post_init__(self) -> None:
        require_window(self, "min_ratio", "max_ratio")


class ShareTable(FileTable, frozen=True, kw_only=True):
    """The ``[turning_share]`` table: feed and back force over the cutting force."""

    feed_share: Share
    min_feed_share: Share
    max_feed_share: Share
    back_share: Share
    min_back_share: Share
    max_back_share: Share
    source: str

    def __post_init__(self) -> None:
        for name in ("feed", "back"):
            low, share, high = self.window(name)
            if not low <= share <= high:
                message = f"{share:g} is not within {low:g} to {high:g}"
                raise KeyFault(f"{name}_share", message)

    def window(self, name: str) -> tuple[float, float, float]:
        """Least, usual and greatest share of the feed or the back force."""
        low, share, high = (getattr(self, f"{end}{name}_share") for end in ("min_", "", "max_"))
        return low, share, high


CALIBRATION_VERSION = 1
"""Version of the ``[calibration]`` table."""


class LearnedLaw(FileTable, frozen=True, kw_only=True):
    """Posterior of one law; the covariance is over the prior's standard deviations."""

    names: tuple[str, ...]
    mean: tuple[float, ...]
    prior_mean: tuple[float, ...]
    prior_sd: tuple[float, ...]
    covariance: tuple[tuple[float, ...], ...]
    sigma: float
    degrees: float
    count: int
    range: dict[str, tuple[float, ...]]

    @property
    def surface(self) -> SurfaceSpread:
        """Law of Ra, in the order of its parameters."""
        if self.names != NAMES:
            raise KeyFault("names", f"must be {', '.join(NAMES)}")
        sd = self.prior_sd
        return SurfaceSpread(
            mean=self.mean,
            covariance=tuple(
                tuple(value * one * two for value, two in zip(row, sd, strict=True))
                for row, one in zip(self.covariance, sd, strict=True)
            ),
            sigma=self.sigma,
            degrees=self.degrees,
            count=self.count,
        )


class CalibrationTable(FileTable, frozen=True, kw_only=True):
    """The ``[calibration]`` table: measured rows, and what was known before them.

    The laws are told for readers; a later fit starts from rows and priors.
    """

    version: int
    digest: str
    edge_material: CuttingMaterial
    wear_criterion_mm: float
    prior_k_c11_n_mm2: SpecificForce
    prior_m_c: KienzleExponent
    prior_exponent: TaylorExponent | None = None
    prior_constant_m_min: CuttingSpeed | None = None
    rows: str
    forces: LearnedLaw | None = None
    roughness: LearnedLaw | None = None
    life: LearnedLaw | None = None

    def __post_init__(self) -> None:
        require_together(self, "prior_exponent", "prior_constant_m_min")
        if self.version != CALIBRATION_VERSION:
            message = f"{self.version}; this program reads version {CALIBRATION_VERSION}"
            raise KeyFault("version", message)


class MaterialHead(TableHead, frozen=True, kw_only=True):
    """Names of a material: what stands in the root of its file."""

    title: str
    equivalents: tuple[str, ...] = ()


class MaterialFile(FileTable, frozen=True, kw_only=True):
    """A whole file of a work material."""

    title: str
    iso_group: IsoGroup
    equivalents: tuple[str, ...] = ()
    condition: str | None = None
    hardness_hb: Hardness | None = None
    density_g_cm3: Density | None = None
    tensile_strength_n_mm2: Strength | None = None
    youngs_modulus_n_mm2: Modulus | None = None
    youngs_modulus_source: str | None = None
    source: str
    confidence: str
    remarks: tuple[str, ...] = ()
    kienzle: OwnKienzleTable
    kienzle_alternative: tuple[KienzleAlternative, ...] = ()
    linear_edge: LinearEdgeTable | None = None
    linear_edge_alternative: tuple[LinearEdgeTable, ...] = ()
    window: tuple[WindowRow, ...] = ()
    tool_life: tuple[ToolLifeRow, ...] = ()
    feed_per_tooth: FeedTable | None = None
    turning_share: ShareTable | None = None
    calibration: CalibrationTable | None = None

    def __post_init__(self) -> None:
        require_together(self, "youngs_modulus_n_mm2", "youngs_modulus_source")
        served = {row.cutting_material for row in self.window}
        lives = dict.fromkeys(row.cutting_material for row in self.tool_life)
        without = ", ".join(each for each in lives if each not in served)
        if without:
            raise KeyFault("tool_life", f"{without} has no [[window]]")


def read_material(path: Path) -> WorkMaterial:
    """Material of a TOML file, in canonical units, named as the file.

    Raises
    ------
    LibraryError
        A key is missing, unknown or out of its range.
    """
    file = read_toml(path, MaterialFile)
    kienzle, feed, group = file.kienzle, file.feed_per_tooth, file.iso_group
    sides = _sides(file)
    spread, modulus = kienzle.spread, file.youngs_modulus_n_mm2
    condition = () if file.condition is None else (f"condition: {file.condition}",)
    learned = None if file.calibration is None else file.calibration.roughness
    return WorkMaterial(
        name=path.stem,
        title=file.title,
        iso_group=group,
        equivalents=file.equivalents,
        hardness_hb=file.hardness_hb,
        density=file.density_g_cm3,
        tensile_strength=file.tensile_strength_n_mm2,
        kienzle=kienzle.kienzle,
        linear_edge=None if file.linear_edge is None else file.linear_edge.linear_edge,
        windows=_windows(file),
        min_feed_per_tooth_ratio=None if feed is None else feed.min_ratio,
        max_feed_per_tooth_ratio=None if feed is None else feed.max_ratio,
        max_feed_per_tooth=None if feed is None else feed.max_mm,
        source=kienzle.source,
        remarks=(*condition, file.confidence, *file.remarks, sides.remark),
        feed_force=sides.feed,
        back_force=sides.back,
        spread=USUAL_SPREAD[group] if spread is None else spread,
        youngs_modulus=LEAST_MODULUS[group] if modulus is None else modulus,
        surface=None if learned is None else learned.surface,
    )


def _windows(file: MaterialFile) -> tuple[CuttingWindow, ...]:
    """Cutting-speed windows, each with the tool life of its cutting material."""
    lives: Mapping[CuttingMaterial, Taylor] = {
        row.cutting_material: Taylor(
            exponent=row.exponent,
            constant=speed_from_m_min(row.constant_m_min),
            feed_exponent=row.feed_exponent,
            depth_exponent=row.depth_exponent,
            feed=row.feed_mm,
            depth=row.depth_mm,
        )
        for row in file.tool_life
    }
    return tuple(
        CuttingWindow(
            cutting_material=row.cutting_material,
            tool_body=row.tool_body,
            min_cutting_speed=row.speeds[0],
            max_cutting_speed=row.speeds[1],
            taylor=lives.get(row.cutting_material),
        )
        for row in file.window
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class _Sides:
    """Feed and back force of turning."""

    feed: Kienzle | None = None
    back: Kienzle | None = None
    remark: str = (
        f"turning: feed force {FEED_SHARE:g} (0.27 to 0.80), back force {BACK_SHARE:g} (0.16 to"
        " 0.36) of the cutting force, sharp edge: median and range of seven other steels and"
        " irons; within the nose of the tool the back force is far more"
    )


def _sides(file: MaterialFile) -> _Sides:
    """Measured shares, else pairs of the first source that has them, else the usual shares."""
    cutting = file.kienzle.kienzle
    if file.turning_share is not None:
        return _shares(file.turning_share, cutting)
    for row in file.kienzle_alternative:
        feed = _pair(row.k_f11_n_mm2, row.one_minus_m_f)
        if feed is not None:
            return _Sides(
                feed=feed,
                back=_pair(row.k_p11_n_mm2, row.one_minus_m_p),
                remark="turning: feed and back force by Kienzle pairs of their own: "
                + row.source,
            )
    return _Sides()


def _pair(k_11: float | None, one_minus_m: float | None) -> Kienzle | None:
    """The pair ``(k_i1.1, m_i)`` of a component."""
    if k_11 is None or one_minus_m is None:
        return None
    return Kienzle(k_c11=k_11, m_c=1.0 - one_minus_m)


def _shares(table: ShareTable, cutting: Kienzle) -> _Sides:
    """Measured shares of the cutting force, each with its range."""
    words, sides = [], []
    for name in ("feed", "back"):
        low, share, high = table.window(name)
        sides.append(Kienzle(k_c11=share * cutting.k_c11, m_c=cutting.m_c))
        words.append(f"{name} force {share:g} ({low:g} to {high:g})")
    return _Sides(
        feed=sides[0],
        back=sides[1],
        remark=f"turning: {', '.join(words)} of the cutting force: {table.source}",
    )
