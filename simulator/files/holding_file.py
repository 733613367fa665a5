"""Work-holding: ``[[holding]]`` tables of a machine's file, or of one of their own.

Each holds one setup, by the id that the program gives it, or any. What is absent of a chuck's
grip follows from the bar and the clamping positions of the program.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

from simulator.errors import LibraryError
from simulator.files.toml_file import (
    FileTable,
    KeyFault,
    quantity,
    read_toml,
    require_together,
    require_whole,
    shortest,
)
from simulator.spec import MachineKind
from simulator.work_holding import (
    CLAMPING_SAFETY,
    HOLDING_SAFETY,
    Chuck,
    Clamp,
    Holding,
)
from stepnc_model.units import (
    kn_from_newtons,
    newtons_from_kn,
    rev_s_from_rpm,
    rpm_from_rev_s,
)

Force = Annotated[float, quantity(0.01, 10_000, "kN")]
FrictionCoefficient = Annotated[float, quantity(0.01, 1)]
SafetyFactor = Annotated[float, quantity(1, 20)]
Grip = Annotated[float, quantity(0.1, 5_000, "mm")]
Position = Annotated[float, quantity(-100_000, 100_000, "mm")]
Jaws = Annotated[float, quantity(2, 12)]
JawMass = Annotated[float, quantity(0.001, 1_000, "kg")]
LossSpeed = Annotated[float, quantity(1, 500_000, "rpm")]

THREE_JAWS = 3.0


class ChuckRow(FileTable, tag_field="kind", tag="chuck", frozen=True, kw_only=True):
    """``[[holding]]`` row of a chuck.

    Mass and radius of a jaw are given together, and so are a loss of force and its speed.
    """

    setup: str = ""
    clamping_force_kn: Force
    friction: FrictionCoefficient
    jaws: Jaws = THREE_JAWS
    grip_diameter_mm: Grip | None = None
    grip_length_mm: Grip | None = None
    jaw_face_z_mm: Position | None = None
    jaw_mass_kg: JawMass | None = None
    jaw_radius_mm: Grip | None = None
    lost_force_kn: Force | None = None
    lost_at_rpm: LossSpeed | None = None
    safety_factor: SafetyFactor = HOLDING_SAFETY
    clamping_safety_factor: SafetyFactor = CLAMPING_SAFETY
    tailstock: bool | None = None
    source: str

    def __post_init__(self) -> None:
        require_whole(self, "jaws")
        require_together(self, "jaw_mass_kg", "jaw_radius_mm")
        require_together(self, "lost_force_kn", "lost_at_rpm")

    @property
    def holding(self) -> Chuck:
        """Chuck in canonical units."""
        return Chuck(
            clamping_force=newtons_from_kn(self.clamping_force_kn),
            friction=self.friction,
            source=self.source,
            setup=self.setup.strip(),
            jaws=int(self.jaws),
            grip_diameter=self.grip_diameter_mm,
            grip_length=self.grip_length_mm,
            jaw_face=self.jaw_face_z_mm,
            jaw_mass=self.jaw_mass_kg or 0.0,
            jaw_radius=self.jaw_radius_mm or 0.0,
            lost_force=newtons_from_kn(self.lost_force_kn or 0.0),
            lost_at=rev_s_from_rpm(self.lost_at_rpm or 0.0),
            safety_factor=self.safety_factor,
            clamping_safety_factor=self.clamping_safety_factor,
            has_tailstock=self.tailstock,
        )


class ViceRow(FileTable, tag_field="kind", tag="vice", frozen=True, kw_only=True):
    """``[[holding]]`` row of a vice."""

    setup: str = ""
    holding_force_kn: Force
    friction: FrictionCoefficient
    safety_factor: SafetyFactor = HOLDING_SAFETY
    source: str

    @property
    def holding(self) -> Clamp:
        """Vice or clamps in canonical units."""
        return Clamp(
            holding_force=newtons_from_kn(self.holding_force_kn),
            friction=self.friction,
            source=self.source,
            setup=self.setup.strip(),
            safety_factor=self.safety_factor,
        )


class ClampsRow(ViceRow, tag="clamps", frozen=True, kw_only=True):
    """``[[holding]]`` row of clamps, which hold as a vice does."""


HoldingRow = ChuckRow | ViceRow | ClampsRow


class HoldingFile(FileTable, frozen=True, kw_only=True):
    """A file that has nothing but work-holding."""

    holding: tuple[HoldingRow, ...] = ()

    def __post_init__(self) -> None:
        require_distinct(self.holding)


def read_holding_file(path: Path, kind: MachineKind) -> tuple[Holding, ...]:
    """Work-holding for one kind of machine, of a TOML file that has nothing else.

    Raises
    ------
    LibraryError
        A key is missing, unknown or out of its range, or the file holds nothing.
    """
    rows = read_toml(path, HoldingFile).holding
    if not rows:
        raise LibraryError("has no [[holding]]", path=str(path))
    try:
        require_kind(rows, kind)
    except KeyFault as error:
        raise LibraryError(str(error), path=str(path), key=error.key) from error
    return tuple(row.holding for row in rows)


def require_distinct(rows: Sequence[HoldingRow]) -> None:
    """Refuse rows that hold the same setup."""
    setups = [row.setup.strip().casefold() for row in rows]
    for at, setup in enumerate(setups, start=1):
        if setups.count(setup) > 1:
            message = f"'{setup}' is held twice" if setup else "missing twice"
            raise KeyFault(f"holding[{at}].setup", message)


def require_kind(rows: Sequence[HoldingRow], kind: MachineKind) -> None:
    """Refuse a chuck on a mill, and a vice or clamps on a lathe: a chuck turns."""
    for at, row in enumerate(rows, start=1):
        if isinstance(row, ChuckRow) is not (kind is MachineKind.LATHE):
            what = row.__struct_config__.tag
            raise KeyFault(f"holding[{at}].kind", f"a {what} on a {kind}")


def holding_row(holding: Holding) -> HoldingRow:
    """Row of a file in which work-holding reads back equal; clamps become a vice."""
    if isinstance(holding, Clamp):
        return ViceRow(
            setup=holding.setup,
            holding_force_kn=_kn(holding.holding_force),
            friction=holding.friction,
            safety_factor=holding.safety_factor,
            source=holding.source,
        )
    lost_at = shortest(holding.lost_at, rpm_from_rev_s, rev_s_from_rpm)
    return ChuckRow(
        setup=holding.setup,
        clamping_force_kn=_kn(holding.clamping_force),
        friction=holding.friction,
        jaws=float(holding.jaws),
        grip_diameter_mm=holding.grip_diameter,
        grip_length_mm=holding.grip_length,
        jaw_face_z_mm=holding.jaw_face,
        jaw_mass_kg=holding.jaw_mass or None,
        jaw_radius_mm=holding.jaw_radius or None,
        lost_force_kn=_kn(holding.lost_force) or None,
        lost_at_rpm=lost_at or None,
        safety_factor=holding.safety_factor,
        clamping_safety_factor=holding.clamping_safety_factor,
        tailstock=holding.has_tailstock,
        source=holding.source,
    )


def _kn(force: float) -> float:
    return shortest(force, kn_from_newtons, newtons_from_kn)
