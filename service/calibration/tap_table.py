"""A tap test on a terminal, and as JSON."""

from service.calibration.tap_test import TapTestResult
from service.tables import print_findings, print_line, print_table
from service.wire import dump, finding_json
from simulator.machine_toml import modes_toml
from stepnc_model.units import n_um_from_n_mm


def print_tap_test(result: TapTestResult) -> None:
    """Modes as a table, then as the tables of a machine file."""
    rows = [
        (
            mode.direction.value,
            f"{mode.natural_frequency:g}",
            f"{mode.damping_ratio:g}",
            f"{n_um_from_n_mm(mode.stiffness):g}",
        )
        for mode in result.modes
    ]
    print_table(("direction", "frequency Hz", "damping ratio", "stiffness N/µm"), rows)
    print_line(
        f"unexplained: {result.fit.unexplained:.1%} of the response, "
        f"{result.fit.residual:.1%} with residues of modes outside its range"
    )
    for line in modes_toml(result.modes).splitlines():
        print_line(line)
    print_findings(result.findings)


def tap_test_json(result: TapTestResult) -> str:
    """Modes in the units of a machine file, and what they leave."""
    return dump({
        "modes": [
            {
                "part": mode.part.value,
                "tool": mode.tool or None,
                "tool_diameter_mm": mode.tool_diameter,
                "direction": mode.direction.value,
                "frequency_hz": mode.natural_frequency,
                "damping_ratio": mode.damping_ratio,
                "stiffness_n_um": n_um_from_n_mm(mode.stiffness),
                "source": mode.source,
            }
            for mode in result.modes
        ],
        "residual": result.fit.residual,
        "unexplained": result.fit.unexplained,
        "findings": [finding_json(finding) for finding in result.findings],
    })
