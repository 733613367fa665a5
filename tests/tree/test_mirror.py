"""Every module has a test, and is short enough to read.

A test of a module is its mirror in ``tests``, an example in a docstring of it, or any test that
imports it. What only runs through other modules is listed below, with the tests that run it.
"""

import re
from functools import cache
from pathlib import Path

from benchmarks.house import ROOT
from tests.tree.sources import modules

TESTS = ROOT / "tests"
IMPORT = re.compile(r"^ *from ([\w.]+) import (\([^)]*\)|.*)$", flags=re.MULTILINE)

THROUGH = {
    "simulator/physics/test_surface_spread.py": ("simulator/surface_law.py",),
    "extras/linuxcnc/test_bench.py": ("extras/linuxcnc/session.py",),
    "simulator/motion/test_linuxcnc_planner.py": ("simulator/motion/corner_blends.py",),
    "stepnc_model/ap238/test_export.py": (
        "stepnc_model/ap238/building.py",
        "stepnc_model/ap238/drafting.py",
        "stepnc_model/ap238/requirements.py",
    ),
    "stepnc_model/ap238/test_reading.py": (
        "stepnc_model/ap238/reference_paths.py",
        "stepnc_model/ap238/orientation.py",
    ),
    "stepnc_model/entities/test_order.py": ("stepnc_model/entities/workpiece.py",),
    "stepnc_model/nc/test_macros.py": ("stepnc_model/nc/flow_keywords.py",),
    "stepnc_model/nc/test_exact_reading.py": (
        "stepnc_model/nc/klartext_cycles.py",
        "stepnc_model/nc/klartext_switches.py",
        "stepnc_model/nc/spindle.py",
        "stepnc_model/nc/switches.py",
    ),
    "stepnc_model/nc/test_program.py": (
        "stepnc_model/nc/drilling.py",
        "stepnc_model/nc/heidenhain_control.py",
        "stepnc_model/nc/iso_codes.py",
        "stepnc_model/nc/iso_flow.py",
        "stepnc_model/nc/iso_motions.py",
        "stepnc_model/nc/remarks.py",
        "stepnc_model/nc/sinumerik_control.py",
    ),
    "stepnc_model/nc/test_rewrite.py": (
        "stepnc_model/nc/fed_blocks.py",
        "stepnc_model/nc/feed_rows.py",
    ),
    "stepnc_model/nc/test_rs274.py": (
        "stepnc_model/nc/iso_control.py",
        "stepnc_model/nc/iso_modes.py",
        "stepnc_model/nc/split.py",
    ),
    "extras/calibration/model/test_cut_fit.py": ("extras/calibration/model/log_model.py",),
    "extras/calibration/verbs/calibrate/test_cuts.py": (
        "extras/calibration/verbs/validate/request.py",
        "extras/calibration/verbs/validate/result.py",
        "extras/calibration/verbs/validate/run.py",
        "extras/calibration/model/material_text.py",
    ),
    "extras/factory/model/test_queueing.py": ("extras/factory/model/upkeep.py",),
    "extras/factory/model/test_shop_file.py": ("extras/factory/model/shop_tables.py",),
    "extras/factory/model/test_station.py": (
        "extras/factory/model/crews.py",
        "extras/factory/model/state_book.py",
        "extras/factory/model/surroundings.py",
    ),
    "service/verbs/optimise/test_path_only.py": ("optimiser/cuts/bare_path.py",),
    "optimiser/bounds/test_holding.py": ("optimiser/planning/holding_demand.py",),
    "extras/agent/test_run.py": ("extras/agent/model/machine_feed.py",),
    "service/along_path/test_caution.py": (
        "optimiser/along_path/change_bounds.py",
        "service/simulation/line_spans.py",
    ),
    "service/along_path/test_code_job.py": ("optimiser/along_path/holding_limits.py",),
    "service/cli/test_code.py": ("service/simulation/line_spans.py",),
    "service/along_path/test_output.py": ("service/along_path/figures.py",),
    "service/along_path/test_run.py": ("service/along_path/program_feeds.py",),
    "extras/factory/test_factory.py": (
        "extras/factory/parts_file.py",
        "extras/factory/states_file.py",
    ),
    "service/jobs/test_runner.py": ("service/jobs/frozen.py",),
    "service/verbs/kbe/test_run.py": ("service/requests/output.py",),
    "service/rest/test_agent.py": (
        "extras/agent/rest.py",
        "extras/agent/shop.py",
    ),
    "service/rest/test_resource.py": (
        "extras/factory/jobs.py",
        "extras/verification/jobs.py",
        "service/jobs/stored_verb.py",
    ),
    "service/rest/test_factories.py": (
        "extras/factory/rest.py",
        "extras/factory/views.py",
    ),
    "service/rest/test_monitors.py": ("service/rest/monitor_views.py",),
    "service/rest/test_programs.py": ("service/rest/uploads.py",),
    "service/storage": ("service/storage/connection.py",),
    "service/test_keep_going.py": (
        "stepnc_model/editing/own_operation.py",
        "stepnc_model/toolpath/omissions.py",
        "service/programs/refusals.py",
    ),
    "service/processes/test_log_lines.py": ("service/processes/fork_log.py",),
    "service/test_report.py": ("service/plots/plan_figures.py",),
    "service/verbs/test_verb.py": ("service/requests/files.py",),
    "extras/linuxcnc/test_drive.py": ("service/simulation/drive.py",),
    "service/verbs/check/test_uses.py": ("service/programs/remarks.py",),
}
"""tests, and the modules that they run through others"""


def mirror(module: str) -> Path:
    """Test module in the place that mirrors a module's own; that of a verb runs its folder.

    Verbs of one group, whose folders stand in that of the group, are run by one.
    """
    path, parts = TESTS / module, Path(module).parts
    if "verbs" in parts[:-2]:
        return TESTS.joinpath(*parts[: parts.index("verbs") + 2], "test_run.py")
    return path.with_name(f"test_{path.name}")


def imported_by_tests() -> set[str]:
    """Dotted names that the tests import; those that only read sources test nothing."""
    found: set[str] = set()
    for path in TESTS.rglob("*.py"):
        if path.parent.name != "tree":
            for module, names in IMPORT.findall(path.read_text(encoding="utf-8")):
                found |= {module, *(f"{module}.{name}" for name in re.findall(r"\w+", names))}
    return found


@cache
def without_test() -> list[str]:
    """Modules without a test of their own."""
    imported = imported_by_tests()
    return [
        module
        for module, text in modules().items()
        if not mirror(module).exists()
        and ">>> " not in text
        and module.removesuffix(".py").replace("/", ".") not in imported
    ]


def listed() -> list[str]:
    """Modules that are listed above."""
    return [module for run in THROUGH.values() for module in run]


def test_every_module_has_a_test() -> None:
    assert [module for module in without_test() if module not in listed()] == []


def test_only_modules_without_a_test_of_their_own_are_listed() -> None:
    assert [module for module in listed() if module not in without_test()] == []
    assert [place for place in THROUGH if not (TESTS / place).exists()] == []


def test_modules_are_short_enough_to_read() -> None:
    lengths = {module: len(text.splitlines()) for module, text in modules().items()}
    assert {module: length for module, length in lengths.items() if length > 500} == {}
