"""Selection of the measured modes of a machine that apply to a cut."""

from dataclasses import dataclass

from optimiser.cut import Cut, CutKind
from simulator.spec import Machine, ModeDirection, VibratingPart, VibrationMode
from stepnc_model.tool import Tool

SAME_DIAMETER = 1e-3
"""Tolerance within which tool diameters are equal, mm."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasuredModes:
    """Measured vibration modes that apply to one cut, along the axes of the machine."""

    x: tuple[VibrationMode, ...]
    y: tuple[VibrationMode, ...]
    z: tuple[VibrationMode, ...]

    @property
    def in_plane(self) -> tuple[VibrationMode, ...]:
        """Modes that affect milling, each once."""
        return tuple(dict.fromkeys((*self.x, *self.y)))

    @property
    def along_axis(self) -> tuple[VibrationMode, ...]:
        """Modes that affect turning, each once."""
        return tuple(dict.fromkeys((*self.x, *self.z)))


def measured_modes(cut: Cut, machine: Machine) -> MeasuredModes | None:
    """Measured modes that apply to a cut: those that name its tool, or else its diameter."""
    if cut.kind not in {CutKind.MILLING, CutKind.TURNING}:
        return None
    fitting = [mode for mode in machine.modes if _is_of(mode, cut.tool)]
    named = [mode for mode in fitting if mode.tool]
    work = [mode for mode in machine.modes if mode.part is VibratingPart.WORKPIECE]
    kept = (*(named or fitting), *work)
    found = MeasuredModes(
        x=tuple(mode for mode in kept if mode.direction in {ModeDirection.X, ModeDirection.XY}),
        y=tuple(mode for mode in kept if mode.direction in {ModeDirection.Y, ModeDirection.XY}),
        z=tuple(mode for mode in kept if mode.direction is ModeDirection.Z),
    )
    felt = found.in_plane if cut.kind is CutKind.MILLING else found.along_axis
    return found if felt else None


def _is_of(mode: VibrationMode, tool: Tool) -> bool:
    """Whether a mode was measured on a given tool."""
    if mode.part is not VibratingPart.TOOL:
        return False
    if mode.tool and mode.tool.casefold() != tool.id.strip().casefold():
        return False
    diameter = mode.tool_diameter
    return diameter is None or abs(diameter - tool.diameter) <= SAME_DIAMETER


def what_is_measured(cut: Cut, measured: MeasuredModes) -> str:
    """Describe the number of modes and the directions assumed to be rigid."""
    modes = measured.in_plane if cut.kind is CutKind.MILLING else measured.along_axis
    text = f"{len(modes)} measured mode{'' if len(modes) == 1 else 's'}"
    if not any(mode.part is VibratingPart.TOOL for mode in modes):
        text += " of the workpiece, the tool taken as rigid"
    if cut.kind is CutKind.MILLING and not (measured.x and measured.y):
        text += f", {'x' if measured.y else 'y'} taken as rigid"
    return text
