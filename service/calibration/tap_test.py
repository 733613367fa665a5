"""Tap test: modes of a tool or workpiece fitted to a measured frequency response."""

from dataclasses import dataclass, replace
from pathlib import Path

from service.files import require_place, write_atomically
from service.reading import Tell, one_of, silent
from simulator.calibration.modal_fit import ModalFit, fitted_modes, read_response
from simulator.errors import CalibrationError
from simulator.library import load_machine
from simulator.machine_file import (
    Damping,
    Frequency,
    ModeDiameter,
    Stiffness,
    machine_toml,
)
from simulator.spec import Machine, ModeDirection, VibratingPart, VibrationMode
from simulator.toml_file import complaint
from stepnc_model.errors import Finding, Severity, StepNcError
from stepnc_model.units import n_um_from_n_mm

MOST_UNEXPLAINED = 0.2
"""Unexplained share of the response above which a warning is given."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TapTestRequest:
    """Request of ``taptest``, in the user's units."""

    response: Path
    direction: str
    tool: str = ""
    """Id of the tool as used in programs."""
    tool_diameter_mm: float | None = None
    workpiece: bool = False
    """Whether the workpiece was tapped instead of a tool."""
    modes: int | None = None
    source: str = ""
    machine: str = ""
    output: Path | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class TapTestResult:
    """Result of ``taptest``."""

    modes: tuple[VibrationMode, ...]
    fit: ModalFit
    findings: tuple[Finding, ...]


def tap_test(request: TapTestRequest, *, tell: Tell = silent) -> TapTestResult:
    """Fit modes to a frequency response and, if an output is named, write a machine file.

    Existing modes of the same part in the same direction are replaced.

    Raises
    ------
    StepNcError
        When the response, an option or the output is invalid; nothing is written.
    """
    direction = one_of(ModeDirection, request.direction.lower(), "direction")
    _require_part(request)
    machine = _machine(request)
    path = str(request.response)
    fit = fitted_modes(read_response(request.response), count=request.modes, path=path)
    modes = tuple(
        VibrationMode(
            part=VibratingPart.WORKPIECE if request.workpiece else VibratingPart.TOOL,
            tool=request.tool.strip(),
            tool_diameter=request.tool_diameter_mm,
            direction=direction,
            natural_frequency=_rounded(mode.natural_frequency),
            damping_ratio=_rounded(mode.damping_ratio),
            stiffness=_rounded(mode.stiffness),
            source=request.source or f"tap test {request.response.name}",
        )
        for mode in fit.modes
    )
    for mode in modes:
        _require_usual(mode, path)
    if machine is not None and request.output is not None:
        kept = tuple(
            left for old in machine.modes if (left := _left_of(old, modes[0])) is not None
        )
        text = machine_toml(replace(machine, modes=(*kept, *modes)))
        write_atomically(request.output, text.encode())
        tell(f"machine file: {request.output}")
    return TapTestResult(modes=modes, fit=fit, findings=tuple(_doubts(fit)))


def _require_part(request: TapTestRequest) -> None:
    """Require a tool, by its id or diameter, or the workpiece."""
    is_tool = bool(request.tool.strip()) or request.tool_diameter_mm is not None
    if is_tool is request.workpiece:
        raise StepNcError(
            "name what was tapped: --tool ID or --tool-diameter-mm MM, or --workpiece"
        )
    if refused := complaint(request.tool_diameter_mm, ModeDiameter | None):
        raise StepNcError(f"tool diameter: {refused}")
    if request.modes is not None and request.modes < 1:
        raise StepNcError(f"{request.modes} modes: at least 1 is needed")


def _machine(request: TapTestRequest) -> Machine | None:
    """Load the machine to be written; None without an output."""
    if request.output is None:
        if request.machine:
            raise StepNcError("--machine is written with its new modes: name a file with -o")
        return None
    if not request.machine:
        raise StepNcError("-o writes a machine file: name the machine with --machine")
    require_place(request.output, apart_from=request.response)
    return load_machine(request.machine)


def _rounded(value: float) -> float:
    """Round to the digits that a tap test can resolve."""
    return float(f"{value:.4g}")


def _require_usual(mode: VibrationMode, path: str) -> None:
    """Refuse a mode outside the bounds of machine files."""
    for what, value, allowed in (
        ("natural frequency", mode.natural_frequency, Frequency),
        ("damping ratio", mode.damping_ratio, Damping),
        ("stiffness", n_um_from_n_mm(mode.stiffness), Stiffness),
    ):
        if refused := complaint(value, allowed):
            raise CalibrationError(f"{what}: {refused}; check the unit", path=path)


def _left_of(old: VibrationMode, new: VibrationMode) -> VibrationMode | None:
    """Return the old mode without the newly measured directions; None if none is left."""
    same = (new.part, new.tool.casefold(), new.tool_diameter) == (
        old.part,
        old.tool.casefold(),
        old.tool_diameter,
    )
    left = set(old.direction.value) - set(new.direction.value) if same else set()
    if not same or left == set(old.direction.value):
        return old
    return replace(old, direction=ModeDirection(left.pop())) if left else None


def _doubts(fit: ModalFit) -> list[Finding]:
    """Return a warning if the fit leaves too much unexplained."""
    if fit.unexplained <= MOST_UNEXPLAINED:
        return []
    text = (
        f"the modes leave {fit.unexplained:.0%} of the response unexplained: "
        "check its coherence, or request another number of modes"
    )
    return [Finding(severity=Severity.WARNING, message=text)]
