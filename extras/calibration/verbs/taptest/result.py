"""Result of ``taptest``: modes as a table and as tables of a machine file."""

from dataclasses import dataclass

from extras.calibration.model.modal_fit import ModalFit
from service.rendering.columns import Column
from service.rendering.view import Fact, Findings, ResultView, Table, TextLine
from service.verbs.result import Result
from simulator.files.mode_file import modes_toml
from simulator.spec import VibrationMode
from stepnc_model.errors import Finding
from stepnc_model.units import n_um_from_n_mm

MODES: tuple[Column[VibrationMode], ...] = (
    Column(key="part", value=lambda mode: mode.part.value),
    Column(key="tool", value=lambda mode: mode.tool or None),
    Column(key="tool_diameter_mm", value=lambda mode: mode.tool_diameter),
    Column(key="direction", heading="direction", value=lambda mode: mode.direction.value),
    Column(
        key="frequency_hz", heading="frequency Hz", form="g", help="f_n",
        value=lambda mode: mode.natural_frequency,
    ),
    Column(
        key="damping_ratio", heading="damping ratio", form="g", help="ζ",
        value=lambda mode: mode.damping_ratio,
    ),
    Column(
        key="stiffness_n_um", heading="stiffness N/µm", form="g", help="k",
        value=lambda mode: n_um_from_n_mm(mode.stiffness),
    ),
    Column(key="source", value=lambda mode: mode.source),
)  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class TapTestResult(Result):
    """Result of ``taptest``."""

    modes: tuple[VibrationMode, ...]
    fit: ModalFit
    findings: tuple[Finding, ...]

    def view(self) -> ResultView:
        """Return the modes, what they leave unexplained, and tables of a machine file."""
        fit = self.fit
        text = (
            f"unexplained: {fit.unexplained:.1%} of the response, "
            f"{fit.residual:.1%} after adding residues of modes outside its range"
        )
        return ResultView([
            Table(key="modes", columns=MODES, rows=self.modes),
            Fact(key="residual", value=fit.residual),
            Fact(key="unexplained", value=fit.unexplained),
            TextLine(text=text),
            *(TextLine(text=line) for line in modes_toml(self.modes).splitlines()),
            Findings(findings=self.findings),
        ])
