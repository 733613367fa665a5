"""Design files of data sets: programs, machines, materials and ranges of settings, in TOML.

Paths are relative to the file. Units are in the keys.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from extras.factory.model.design import DesignKind, ExperimentDesign, FactorRange
from simulator.files.toml_file import FileTable, KeyFault, quantity, read_toml, require_whole
from simulator.library import load_machine
from simulator.spec import Machine
from stepnc_model.units import rev_s_from_rad_s

Feed = Annotated[float, quantity(0.001, 5_000, "mm/s")]
Turning = Annotated[float, quantity(0.1, 50_000, "rad/s")]
Depth = Annotated[float, quantity(0.001, 1_000, "mm")]
ToolDiameter = Annotated[float, quantity(0.01, 2_000, "mm")]
FlankWear = Annotated[float, quantity(0, 2, "mm")]
Levels = Annotated[float, quantity(2, 1_000)]
SeedNumber = Annotated[float, quantity(0, 2**53)]

RANGES = ("feed_mm_s", "spindle_rad_s", "depth_mm", "tool_diameter_mm", "flank_wear_mm")
CATEGORIES = ("program", "machine", "material")


class DesignTable(FileTable, frozen=True, kw_only=True):
    """Root of a design file."""

    program: str | tuple[str, ...]
    machine: str | tuple[str, ...]
    material: str | tuple[str, ...] = ""
    feed_mm_s: tuple[Feed, ...] = ()
    spindle_rad_s: tuple[Turning, ...] = ()
    depth_mm: tuple[Depth, ...] = ()
    tool_diameter_mm: tuple[ToolDiameter, ...] = ()
    flank_wear_mm: tuple[FlankWear, ...] = ()
    design: DesignKind = DesignKind.UNIFORM
    levels: Levels | None = None
    seed: SeedNumber = 1.0
    deviation: bool = False

    def __post_init__(self) -> None:
        for key in RANGES:
            ends = getattr(self, key)
            if ends and (len(ends) != 2 or ends[0] >= ends[1]):
                shown = ", ".join(f"{end:g}" for end in ends)
                raise KeyFault(key, f"[{shown}]: expected a lower and a greater upper bound")
        if not any(getattr(self, key) for key in RANGES):
            raise KeyFault("feed_mm_s", f"nothing varies: give one of {', '.join(RANGES)}")
        for key in CATEGORIES:
            names = _names(getattr(self, key))
            if not names or len(set(names)) < len(names):
                raise KeyFault(key, "expected one name, or a list of different names")
        is_factorial = self.design is DesignKind.FULL_FACTORIAL
        if is_factorial and self.levels is None:
            raise KeyFault("levels", "missing; expected with design = 'full-factorial'")
        if not is_factorial and self.levels is not None:
            raise KeyFault("levels", f"belongs to 'full-factorial', not '{self.design}'")
        for key in ("seed", "levels"):
            if getattr(self, key) is not None:
                require_whole(self, key)


@dataclass(frozen=True, slots=True, kw_only=True)
class DesignFile:
    """Content of a design file."""

    design: ExperimentDesign
    programs: tuple[Path, ...]
    machines: tuple[Machine, ...]
    materials: tuple[str, ...]
    """Names of materials; an empty one stands for what the program names."""
    has_deviation: bool
    """Whether the energies deviate at random, by the machine's ``[deviation]``."""


def read_design(path: Path) -> DesignFile:
    """Read a design file.

    Raises
    ------
    LibraryError
        When it cannot be read, or a value is missing, unknown or out of its range.
    UnknownMachine
        When the library has no machine of a name.
    """
    table = read_toml(path, DesignTable)
    programs, names, materials = (_names(getattr(table, key)) for key in CATEGORIES)
    return DesignFile(
        design=ExperimentDesign(
            kind=table.design,
            seed=int(table.seed),
            programs=len(programs),
            machines=len(names),
            materials=len(materials),
            feed=_range(table.feed_mm_s),
            spindle_speed=_range(tuple(map(rev_s_from_rad_s, table.spindle_rad_s))),
            depth=_range(table.depth_mm),
            tool_diameter=_range(table.tool_diameter_mm),
            flank_wear=_range(table.flank_wear_mm),
            levels=1 if table.levels is None else int(table.levels),
        ),
        programs=tuple(path.parent / name for name in programs),
        machines=tuple(load_machine(_place(name, path.parent)) for name in names),
        materials=tuple(_place(name, path.parent) for name in materials),
        has_deviation=table.deviation,
    )


def _names(value: str | tuple[str, ...]) -> tuple[str, ...]:
    return (value,) if isinstance(value, str) else value


def _place(name: str, folder: Path) -> str:
    """Name of the library, or path of a file relative to a folder."""
    return str(folder / name) if Path(name).suffix else name


def _range(ends: tuple[float, ...]) -> FactorRange | None:
    return FactorRange(low=ends[0], high=ends[1]) if ends else None
