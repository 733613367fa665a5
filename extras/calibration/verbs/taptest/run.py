"""Tap test: modes of a tool or workpiece fitted to a measured frequency response."""

from dataclasses import replace

from extras.calibration.model.modal_fit import ModalFit, fitted_modes, read_response
from extras.calibration.verbs.taptest.request import TapTestFiles, TapTestRequest
from extras.calibration.verbs.taptest.result import TapTestResult
from service.files import require_place, write_atomically
from service.progress import Tell, silent
from simulator.errors import CalibrationError
from simulator.files.machine_file import machine_toml
from simulator.files.mode_file import Damping, Frequency, Stiffness
from simulator.files.toml_file import complaint
from simulator.library import load_machine
from simulator.spec import Machine, ModeDirection, VibratingPart, VibrationMode
from stepnc_model.errors import Finding, Severity, StepNcError
from stepnc_model.units import n_um_from_n_mm

MOST_UNEXPLAINED = 0.2
"""Unexplained share of the response above which a warning is given."""


def run(request: TapTestRequest, files: TapTestFiles, *, tell: Tell = silent) -> TapTestResult:
    """Fit modes to a frequency response and, if an output is named, write a machine file.

    Existing modes of the same part in the same direction are replaced.

    Raises
    ------
    StepNcError
        When the response, an option or the output is invalid; nothing is written.
    """
    _require_part(request)
    machine = _machine(request, files)
    path = str(files.response)
    fit = fitted_modes(read_response(files.response), count=request.modes, path=path)
    modes = tuple(
        VibrationMode(
            part=VibratingPart.WORKPIECE if request.workpiece else VibratingPart.TOOL,
            tool=request.tool.strip(),
            tool_diameter=request.tool_diameter_mm,
            direction=request.direction,
            natural_frequency=_rounded(mode.natural_frequency),
            damping_ratio=_rounded(mode.damping_ratio),
            stiffness=_rounded(mode.stiffness),
            source=request.source or f"tap test {files.response.name}",
        )
        for mode in fit.modes
    )
    for mode in modes:
        _require_usual(mode, path)
    if machine is not None and files.output is not None:
        kept = tuple(
            left for old in machine.modes if (left := _left_of(old, modes[0])) is not None
        )
        text = machine_toml(replace(machine, modes=(*kept, *modes)))
        write_atomically(files.output, text.encode())
        tell(f"machine file: {files.output}")
    return TapTestResult(modes=modes, fit=fit, findings=tuple(_doubts(fit)))


def _require_part(request: TapTestRequest) -> None:
    """Require a tool, by its id or diameter, or the workpiece."""
    is_tool = bool(request.tool.strip()) or request.tool_diameter_mm is not None
    if is_tool is request.workpiece:
        raise StepNcError(
            "name what was tapped: --tool ID or --tool-diameter-mm MM, or --workpiece"
        )


def _machine(request: TapTestRequest, files: TapTestFiles) -> Machine | None:
    """Load the machine to be written; None without an output."""
    if files.output is None:
        if request.machine:
            raise StepNcError("--machine is written with its new modes: name a file with -o")
        return None
    if not request.machine:
        raise StepNcError("-o writes a machine file: name the machine with --machine")
    require_place(files.output, apart_from=files.response)
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
