"""Work-holding: ``[[holding]]`` tables of a machine's file, or of one of their own.

Each holds one setup, by the id that the program gives it, or any. What is absent of a chuck's
grip follows from the bar and the clamping positions of the program.
"""

from enum import StrEnum
from pathlib import Path

from simulator.errors import LibraryError
from simulator.spec import (
    MachineKind,
)
from simulator.toml_file import Range, Table, read_toml
from simulator.work_holding import (
    CLAMPING_SAFETY,
    HOLDING_SAFETY,
    Chuck,
    Clamp,
    Holding,
)
from stepnc_model.units import newtons_from_kn, rev_s_from_rpm

FORCE = Range(low=0.01, high=10_000, unit="kN")
FRICTION = Range(low=0.01, high=1)
SAFETY = Range(low=1, high=20)
GRIP = Range(low=0.1, high=5_000, unit="mm")
PLACE = Range(low=-100_000, high=100_000, unit="mm")
JAWS = Range(low=2, high=12)
MASS = Range(low=0.001, high=1_000, unit="kg")
SPEED = Range(low=1, high=500_000, unit="rpm")

THREE_JAWS = 3


class HoldingKind(StrEnum):
    """Kind of work-holding."""

    CHUCK = "chuck"
    VICE = "vice"
    CLAMPS = "clamps"


def read_holding_file(path: Path, kind: MachineKind) -> tuple[Holding, ...]:
    """Work-holding for one kind of machine, of a TOML file that has nothing else.

    Raises
    ------
    LibraryError
        A key is missing, unknown or out of its range, or the file holds nothing.
    """
    root = read_toml(path)
    holdings = read_holdings(root, kind)
    root.finish()
    if not holdings:
        raise LibraryError("has no [[holding]]", path=str(path))
    return holdings


def read_holdings(root: Table, kind: MachineKind) -> tuple[Holding, ...]:
    """Work-holding of the ``[[holding]]`` rows of a file's root table."""
    rows = root.tables("holding")
    holdings = tuple(_holding(row, kind) for row in rows)
    setups = [holding.setup.casefold() for holding in holdings]
    for row, setup in zip(rows, setups, strict=True):
        if setups.count(setup) > 1:
            raise row.error("setup", f"'{setup}' is held twice" if setup else "missing twice")
    return holdings


def _holding(row: Table, kind: MachineKind) -> Holding:
    """One row; a chuck turns, a vice and clamps stand."""
    what = row.choice("kind", HoldingKind)
    if (what is HoldingKind.CHUCK) is not (kind is MachineKind.LATHE):
        raise row.error("kind", f"a {what} on a {kind}")
    return _chuck(row) if what is HoldingKind.CHUCK else _clamp(row)


def _chuck(row: Table) -> Chuck:
    """A chuck; mass and radius of a jaw, loss and its speed are given together."""
    jaws = row.optional_number("jaws", JAWS) or THREE_JAWS
    if jaws != int(jaws):
        raise row.error("jaws", f"{jaws:g} is no whole number")
    has_jaws = "jaw_mass_kg" in row or "jaw_radius_mm" in row
    has_loss = "lost_force_kn" in row or "lost_at_rpm" in row
    return Chuck(
        clamping_force=newtons_from_kn(row.number("clamping_force_kn", FORCE)),
        friction=row.number("friction", FRICTION),
        source=row.text("source"),
        setup=_setup(row),
        jaws=int(jaws),
        grip_diameter=row.optional_number("grip_diameter_mm", GRIP),
        grip_length=row.optional_number("grip_length_mm", GRIP),
        jaw_face=row.optional_number("jaw_face_z_mm", PLACE),
        jaw_mass=row.number("jaw_mass_kg", MASS) if has_jaws else 0.0,
        jaw_radius=row.number("jaw_radius_mm", GRIP) if has_jaws else 0.0,
        lost_force=newtons_from_kn(row.number("lost_force_kn", FORCE)) if has_loss else 0.0,
        lost_at=rev_s_from_rpm(row.number("lost_at_rpm", SPEED)) if has_loss else 0.0,
        safety_factor=_safety(row, "safety_factor", HOLDING_SAFETY),
        clamping_safety_factor=_safety(row, "clamping_safety_factor", CLAMPING_SAFETY),
        has_tailstock=row.flag("tailstock") if "tailstock" in row else None,
    )


def _clamp(row: Table) -> Clamp:
    """A vice or clamps."""
    return Clamp(
        holding_force=newtons_from_kn(row.number("holding_force_kn", FORCE)),
        friction=row.number("friction", FRICTION),
        source=row.text("source"),
        setup=_setup(row),
        safety_factor=_safety(row, "safety_factor", HOLDING_SAFETY),
    )


def _safety(row: Table, key: str, usual: float) -> float:
    return row.optional_number(key, SAFETY) or usual


def _setup(row: Table) -> str:
    """Id of a setup; empty: any."""
    return row.text("setup").strip() if "setup" in row else ""
