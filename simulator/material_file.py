"""A work material from its TOML file.

Ranges are those of metals that are cut; a number outside is a slip of the unit. Alternative
coefficients k_c1.1 of other catalogues are kept in the files and checked, but not loaded: they
show how far sources differ, 20 to 70 % for the same steel. Pairs of feed and back force are
loaded from there, as no other source has them; else a share that was measured, else the usual
shares of :mod:`simulator.physics.turning`.
"""

from collections.abc import Mapping
from dataclasses import dataclass

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
from simulator.toml_file import Range, Table
from stepnc_model.units import rad_from_deg, speed_from_m_min

ISO_GROUPS = ("P", "M", "K", "N", "S", "H")
"""ISO 513 groups of work materials"""

HARDNESS = Range(low=10, high=800, unit="HB")
DENSITY = Range(low=0.5, high=25, unit="g/cm³")
STRENGTH = Range(low=10, high=4_000, unit="N/mm²")
SPECIFIC_FORCE = Range(low=50, high=10_000, unit="N/mm²")
KIENZLE_EXPONENT = Range(low=0, high=0.9)
RAKE = Range(low=-30, high=45, unit="°")
FORCE_EXPONENT = Range(low=-0.5, high=1)
SHARE = Range(low=0.01, high=3)
SPREAD = Range(low=0, high=2)
SHEAR_COEFFICIENT = Range(low=0, high=10_000, unit="N/mm²")
EDGE_COEFFICIENT = Range(low=0, high=500, unit="N/mm")
CUTTING_SPEED = Range(low=0.1, high=10_000, unit="m/min")
TAYLOR_EXPONENT = Range(low=0.01, high=0.99)
FEED_RATIO = Range(low=1e-5, high=0.1)
FEED_PER_TOOTH = Range(low=1e-4, high=5, unit="mm")

USUAL_SPREAD = {"P": 0.20, "M": 0.20, "K": 0.20, "N": 0.20, "S": 0.25, "H": 0.25}
"""of k_c by ISO group where a file names none: as in the library, where its source stands"""

MODULUS = Range(low=1_000, high=1_000_000, unit="N/mm²")
LEAST_MODULUS = {"P": 2.0e5, "M": 1.9e5, "K": 0.88e5, "N": 0.69e5, "S": 1.03e5, "H": 2.0e5}
"""Young's modulus by ISO group where a file gives none, N/mm², of what bends most in it: carbon
and stainless steel, aluminium and titanium (Machinery's Handbook, 29th ed., mechanical
properties), grey iron GJL-200 (EN 1561, annex)"""


def read_material(table: Table, *, name: str) -> WorkMaterial:
    """Material of a file's root table, in canonical units.

    Raises
    ------
    LibraryError
        A key is missing, unknown or out of its range.
    """
    kienzle = table.table("kienzle")
    cutting = _kienzle(kienzle)
    low, high, greatest = _feed_window(table)
    sides = _sides(table, cutting)
    material = WorkMaterial(
        name=name,
        title=table.text("title"),
        iso_group=iso_group(table),
        equivalents=table.texts("equivalents"),
        hardness_hb=table.optional_number("hardness_hb", HARDNESS),
        density=table.optional_number("density_g_cm3", DENSITY),
        tensile_strength=table.optional_number("tensile_strength_n_mm2", STRENGTH),
        kienzle=cutting,
        linear_edge=_linear_edge(table.table("linear_edge"))
        if "linear_edge" in table
        else None,
        windows=_windows(table),
        min_feed_per_tooth_ratio=low,
        max_feed_per_tooth_ratio=high,
        max_feed_per_tooth=greatest,
        source=kienzle.text("source"),
        remarks=(
            *_condition(table),
            table.text("confidence"),
            *table.texts("remarks"),
            sides.remark,
        ),
        feed_force=sides.feed,
        back_force=sides.back,
        spread=_spread(kienzle, iso_group(table)),
        youngs_modulus=_modulus(table, iso_group(table)),
    )
    table.text("source")
    table.finish()
    return material


def iso_group(table: Table) -> str:
    """ISO 513 group of a material or grade; empty when the material has none."""
    group = table.text("iso_group")
    if group and group not in ISO_GROUPS:
        raise table.error("iso_group", f"'{group}' is none of {', '.join(ISO_GROUPS)}")
    return group


def speed_window(table: Table) -> tuple[float | None, float | None]:
    """Least and greatest cutting speed in mm/s of a table with keys in m/min."""
    low, high = table.window(
        "min_cutting_speed_m_min", "max_cutting_speed_m_min", allowed=CUTTING_SPEED
    )
    return (
        None if low is None else speed_from_m_min(low),
        None if high is None else speed_from_m_min(high),
    )


def _condition(table: Table) -> tuple[str, ...]:
    """Delivery condition as a remark."""
    return (f"condition: {table.text('condition')}",) if "condition" in table else ()


def _kienzle(table: Table) -> Kienzle:
    """Kienzle's law of a table."""
    rake = table.optional_number("rake_angle_deg", RAKE)
    return Kienzle(
        k_c11=table.number("k_c11_n_mm2", SPECIFIC_FORCE),
        m_c=table.number("m_c", KIENZLE_EXPONENT),
        rake_angle=None if rake is None else rad_from_deg(rake),
    )


def _spread(table: Table, group: str) -> float | None:
    """Spread of k_c as its file tells, else as is usual in its ISO group."""
    if "spread" not in table:
        return USUAL_SPREAD.get(group)
    table.text("spread_source")
    return table.number("spread", SPREAD)


def _modulus(table: Table, group: str) -> float | None:
    """Young's modulus as the file tells, else the least of the ISO group."""
    if "youngs_modulus_n_mm2" not in table:
        return LEAST_MODULUS.get(group)
    table.text("youngs_modulus_source")
    return table.number("youngs_modulus_n_mm2", MODULUS)


def _linear_edge(table: Table) -> LinearEdge:
    """Linear-edge model of a table; radial and axial parts may be absent."""
    table.text("source")
    return LinearEdge(
        k_tc=table.number("k_tc_n_mm2", SHEAR_COEFFICIENT),
        k_te=table.number("k_te_n_mm", EDGE_COEFFICIENT),
        k_rc=table.optional_number("k_rc_n_mm2", SHEAR_COEFFICIENT) or 0.0,
        k_re=table.optional_number("k_re_n_mm", EDGE_COEFFICIENT) or 0.0,
        k_ac=table.optional_number("k_ac_n_mm2", SHEAR_COEFFICIENT) or 0.0,
        k_ae=table.optional_number("k_ae_n_mm", EDGE_COEFFICIENT) or 0.0,
    )


def _windows(table: Table) -> tuple[CuttingWindow, ...]:
    """Cutting-speed windows, each with the tool life of its cutting material."""
    lives = _tool_lives(table)
    windows = tuple(_window(row, lives) for row in table.tables("window"))
    without = set(lives) - {window.cutting_material for window in windows}
    if without:
        raise table.error("tool_life", f"{', '.join(without)} has no [[window]]")
    return windows


def _window(table: Table, lives: Mapping[CuttingMaterial, Taylor]) -> CuttingWindow:
    """One ``[[window]]`` row."""
    low, high = speed_window(table)
    cutting_material = table.choice("cutting_material", CuttingMaterial)
    table.text("source")
    return CuttingWindow(
        cutting_material=cutting_material,
        tool_body=table.choice("tool_body", ToolConstruction) if "tool_body" in table else None,
        min_cutting_speed=low,
        max_cutting_speed=high,
        taylor=lives.get(cutting_material),
    )


def _tool_lives(table: Table) -> dict[CuttingMaterial, Taylor]:
    """Taylor's constants by cutting material."""
    lives = {}
    for row in table.tables("tool_life"):
        row.text("source")
        lives[row.choice("cutting_material", CuttingMaterial)] = Taylor(
            exponent=row.number("exponent", TAYLOR_EXPONENT),
            constant=speed_from_m_min(row.number("constant_m_min", CUTTING_SPEED)),
        )
    return lives


def _feed_window(table: Table) -> tuple[float | None, float | None, float | None]:
    """Least and greatest feed per tooth over the diameter, and the greatest in mm."""
    if "feed_per_tooth" not in table:
        return None, None, None
    feed = table.table("feed_per_tooth")
    feed.text("source")
    low, high = feed.window("min_ratio", "max_ratio", allowed=FEED_RATIO)
    return low, high, feed.optional_number("max_mm", FEED_PER_TOOTH)


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


def _sides(table: Table, cutting: Kienzle) -> _Sides:
    """Feed and back force: pairs of the first source that has them, or measured shares.

    Reads, and so checks, the coefficients of all other sources.
    """
    found = [_pairs(row) for row in table.tables("kienzle_alternative")]
    for row in table.tables("linear_edge_alternative"):
        _linear_edge(row)
    if "turning_share" in table:
        return _shares(table.table("turning_share"), cutting)
    return next((each for each in found if each is not None), _Sides())


def _pairs(row: Table) -> _Sides | None:
    """Pairs of feed and back force of one ``[[kienzle_alternative]]``, where it has them."""
    _kienzle(row)
    source = row.text("source")
    if "k_f11_n_mm2" not in row:
        return None
    return _Sides(
        feed=_side(row, "f"),
        back=_side(row, "p"),
        remark=f"turning: feed and back force by Kienzle pairs of their own: {source}",
    )


def _side(row: Table, name: str) -> Kienzle:
    """The pair ``(k_i1.1, m_i)`` of a component."""
    return Kienzle(
        k_c11=row.number(f"k_{name}11_n_mm2", SPECIFIC_FORCE),
        m_c=1.0 - row.number(f"one_minus_m_{name}", FORCE_EXPONENT),
    )


def _shares(table: Table, cutting: Kienzle) -> _Sides:
    """Measured shares of the cutting force, each with its range."""
    words, sides = [], []
    for name in ("feed", "back"):
        share = table.number(f"{name}_share", SHARE)
        low = table.number(f"min_{name}_share", SHARE)
        high = table.number(f"max_{name}_share", SHARE)
        if not low <= share <= high:
            raise table.error(f"{name}_share", f"{share:g} is not within {low:g} to {high:g}")
        sides.append(Kienzle(k_c11=share * cutting.k_c11, m_c=cutting.m_c))
        words.append(f"{name} force {share:g} ({low:g} to {high:g})")
    return _Sides(
        feed=sides[0],
        back=sides[1],
        remark=f"turning: {', '.join(words)} of the cutting force: {table.text('source')}",
    )
