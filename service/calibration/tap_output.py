"""Result of a tap test as text and JSON."""

from service.calibration.tap_test import TapTestResult
from service.rendering.columns import Column
from service.rendering.records import dump, finding_record, records
from service.rendering.text import print_findings, print_line, print_table
from simulator.machine_file import modes_toml
from simulator.spec import VibrationMode
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


def print_tap_test(result: TapTestResult) -> None:
    """Print the modes as a table, then as tables of a machine file."""
    print_table(MODES, result.modes)
    print_line(
        f"unexplained: {result.fit.unexplained:.1%} of the response, "
        f"{result.fit.residual:.1%} after adding residues of modes outside its range"
    )
    for line in modes_toml(result.modes).splitlines():
        print_line(line)
    print_findings(result.findings)


def tap_test_json(result: TapTestResult) -> str:
    """Return the modes in units of a machine file, and the unexplained response, as JSON."""
    return dump({
        "modes": records(MODES, result.modes),
        "residual": result.fit.residual,
        "unexplained": result.fit.unexplained,
        "findings": [finding_record(finding) for finding in result.findings],
    })
