"""Measured modes of vibration as ``[[mode]]`` rows of a machine file."""

from collections.abc import Sequence
from typing import Annotated

from simulator.files.toml_file import FileTable, KeyFault, quantity, shortest, written
from simulator.spec import ModeDirection, VibratingPart, VibrationMode
from stepnc_model.units import n_mm_from_n_um, n_um_from_n_mm

ModeDiameter = Annotated[float, quantity(0.01, 2_000, "mm")]
Frequency = Annotated[float, quantity(1, 50_000, "Hz")]
Damping = Annotated[float, quantity(1e-4, 0.5)]
Stiffness = Annotated[float, quantity(0.001, 10_000, "N/µm")]


class ModeRow(FileTable, frozen=True, kw_only=True):
    """One ``[[mode]]`` row; a mode of a tool names the tool or its diameter."""

    part: VibratingPart
    tool: str = ""
    tool_diameter_mm: ModeDiameter | None = None
    direction: ModeDirection
    frequency_hz: Frequency
    damping_ratio: Damping
    stiffness_n_um: Stiffness
    source: str

    def __post_init__(self) -> None:
        is_named = bool(self.tool.strip()) or self.tool_diameter_mm is not None
        if self.part is VibratingPart.TOOL and not is_named:
            raise KeyFault("tool", "missing; expected the tool's id, or tool_diameter_mm")
        if self.part is VibratingPart.WORKPIECE and is_named:
            raise KeyFault("tool", "a mode of the workpiece belongs to no tool")

    @property
    def mode(self) -> VibrationMode:
        """Mode in canonical units."""
        return VibrationMode(
            part=self.part,
            tool=self.tool.strip(),
            tool_diameter=self.tool_diameter_mm,
            direction=self.direction,
            natural_frequency=self.frequency_hz,
            damping_ratio=self.damping_ratio,
            stiffness=n_mm_from_n_um(self.stiffness_n_um),
            source=self.source,
        )


def modes_toml(modes: Sequence[VibrationMode]) -> str:
    """TOML text of measured modes, a ``[[mode]]`` table each; ends a machine file."""
    rows = [("", "[[mode]]", *written(mode_row(mode))) for mode in modes]
    return "".join(f"{line}\n" for row in rows for line in row)


def mode_row(mode: VibrationMode) -> ModeRow:
    """Row of a mode."""
    return ModeRow(
        part=mode.part,
        tool=mode.tool,
        tool_diameter_mm=mode.tool_diameter,
        direction=mode.direction,
        frequency_hz=mode.natural_frequency,
        damping_ratio=mode.damping_ratio,
        stiffness_n_um=shortest(mode.stiffness, n_um_from_n_mm, n_mm_from_n_um),
        source=mode.source,
    )
