"""Every module has tests of its own, in the place that mirrors its own."""

from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PACKAGES = ("stepnc_model", "simulator", "optimiser", "controller", "kbe", "service")

NOUNS = {
    "stepnc_model/entities": "nouns: test_order.py holds them against the attribute order",
}
"""folders whose modules are tested together"""

TOGETHER = {
    "service/along_path/written_code.py": "run in tests/service/along_path/test_of_code.py",
    "stepnc_model/ap238/building.py": "builds whole programs in tests/.../test_export.py",
    "stepnc_model/ap238/completing.py": "held against the long form in test_export.py",
    "stepnc_model/ap238/converted.py": "a noun; read in test_reading.py",
    "stepnc_model/ap238/dictionary.py": "held against the long form in test_table.py",
    "stepnc_model/ap238/drafting.py": "changes files in test_writing.py and test_export.py",
    "stepnc_model/ap238/following.py": "follows all paths in test_reading.py",
    "stepnc_model/ap238/loose.py": "carries the records of test_writing.py",
    "stepnc_model/ap238/requirements.py": "held against the long form in test_export.py",
    "stepnc_model/ap238/upright.py": "turns the pocket of the example in test_reading.py",
    "stepnc_model/ap238/view.py": "read by every command in test_reading.py",
    "optimiser/along_path/pieces.py": "its parts are checked in along_path/test_runs.py",
    "optimiser/along_path/tool_bounds.py": "kept by tests/service/along_path/test_of_code.py",
    "service/along_path/course.py": "run in tests/service/along_path/test_run.py",
    "service/along_path/plan_run.py": "run in tests/service/along_path/test_run.py",
    "service/along_path/of_program.py": "run in tests/service/along_path/test_run.py",
    "service/along_path/task.py": "run in tests/service/along_path/test_run.py",
    "service/along_path/trace.py": "drawn in tests/service/along_path/test_output.py",
    "service/along_path/figures.py": "drawn in tests/service/along_path/test_output.py",
    "service/along_path/code_output.py": "printed in tests/service/along_path/test_of_code.py",
    "service/cli/code.py": "run in tests/service/along_path/test_of_code.py",
    "simulator/spec.py": "dataclasses only; loaded and checked in tests/simulator",
    "simulator/work_holding.py": "dataclasses only; read in test_holding_file.py",
    "simulator/physics/holding.py": "held against print in tests/reference/test_vdi_3106.py",
    "simulator/physics/slender_bar.py": "likewise in tests/reference/test_slender_bars.py",
    "optimiser/asked_of_holding.py": "told in tests/optimiser/test_holding.py",
    "optimiser/bar_grip.py": "taken from programs in tests/optimiser/test_holding.py",
    "simulator/errors.py": "raised and read in tests/simulator",
    "optimiser/advice.py": "made and read in tests/optimiser/test_optimise.py",
    "optimiser/reasons.py": "read in tests/optimiser/test_optimise.py and test_plunge_feed.py",
    "optimiser/measured.py": "dataclasses only; read in tests/optimiser/test_measured.py",
    "optimiser/least_cost.py": "held against all passes in tests/optimiser/test_workingstep.py",
    "simulator/physics/flutes.py": "edges of tests/simulator/physics/test_tooth_forces.py",
    "optimiser/left_by_path.py": "measured on NIST's file in test_assumed_stock.py",
    "stepnc_model/given.py": "set and withdrawn in tests/service/test_keep_going.py",
    "stepnc_model/withdrawal.py": "set and withdrawn in tests/service/test_keep_going.py",
    "stepnc_model/own_operation.py": "copied for advice in tests/service/test_keep_going.py",
    "stepnc_model/regular_file.py": "asked in tests/service/test_irregular_files.py",
    "stepnc_model/toolpath/left_out.py": "asked in tests/service/test_keep_going.py",
    "stepnc_model/toolpath/remarks.py": "told by every command in tests/service/test_uses.py",
    "service/paths/remarks.py": "told by every command in tests/service/test_uses.py",
    "service/refusals.py": "given for every fault in tests/service/test_keep_going.py",
    "service/confirmation.py": "made and read in tests/service/test_confirm.py",
    "service/figures.py": "drawn in tests/service/test_report.py",
    "controller/loop_settings.py": "dataclasses only; obeyed in tests/controller/test_loop.py",
    "controller/cycle.py": "made and read in tests/controller/test_loop.py",
    "controller/errors.py": "raised and read in tests/controller",
    "controller/law.py": "the interface of tests/controller/laws",
    "controller/ports.py": "Protocols; plugged in tests/controller/test_loop.py",
    "service/storage/connection.py": "Protocols; kept by both databases in storage",
    "service/storage/server_schema.py": "statements; run in storage/test_server_database.py",
    "service/fork_log.py": "read in tests/service/test_log_lines.py",
    "service/rest/web_config.py": "its faults are read in tests/service/test_log_lines.py",
    "service/jobs/frozen.py": "loaded by the runners of tests/service/jobs",
    "service/jobs/review.py": "run in tests/service/jobs/test_evaluate.py",
    "service/jobs/preloaded_common.py": "loads what it names; service/jobs/test_runner.py",
    "service/jobs/preloaded.py": "loads what it names; tests/service/jobs/test_runner.py",
    "service/rest/views.py": "shapes; held against the document in rest/test_openapi.py",
    "service/rest/advice_views.py": "shapes; held against answers in rest/test_code_advice.py",
    "service/requests/stored_advice.py": "asked for in tests/service/rest/test_code_advice.py",
    "service/rest/monitor_views.py": "held against the document in rest/test_monitors.py",
    "service/contents_output.py": "printed in test_plan_output.py and test_output_json.py",
    "service/library_output.py": "printed in test_plan_output.py and test_output_json.py",
    "service/factory/live_status.py": "read in tests/service/factory/test_live.py",
    "service/rest/factory_views.py": "held against the document in rest/test_factories.py",
    "service/dataset/folder.py": "written and read in tests/service/dataset/test_run.py",
    "service/dataset/rows.py": "held against a run in tests/service/dataset/test_run.py",
    "service/requests/learning.py": "fields only; read in tests/service/learning",
    "service/learning/table.py": "refused in tests/service/learning/test_learn.py",
    "service/learning/learned.py": "its box is kept in tests/service/learning/test_predict.py",
    "service/learning/recorded.py": "read in tests/service/learning/test_score.py",
    "service/learning/output.py": "printed in tests/service/cli/test_learning.py",
    "service/learning/figures.py": "drawn in tests/service/cli/test_learning.py",
    "service/cli/dataset.py": "run in tests/service/cli/test_learning.py",
    "service/requests/advice.py": "fields only; read in rest/test_bodies.py and storage",
    "service/requests/blocks.py": "fields only; read in tests/service/blocks",
    "service/requests/recording.py": "fields only; read in tests/service/recording",
    "service/requests/verification.py": "fields only; read in tests/service/verification",
    "service/requests/stored_verification.py": "fields only; read in rest/test_openapi.py",
    "service/requests/stored_cycle_time.py": "fields only; read in rest/test_openapi.py",
    "service/jobs/logs.py": "read in tests/service/jobs/test_verify.py and test_cycle_time.py",
    "service/rest/logged.py": "orders of rest/test_verifications.py and test_cycle_times.py",
    "service/rest/verification_views.py": "shapes; held against rest/test_verifications.py",
    "service/rest/uploads.py": "bodies of rest/test_programs.py and test_files.py",
    "service/cli/record.py": "run in tests/service/cli/test_agent.py",
    "service/agent/shop.py": "its runs are read in tests/service/rest/test_agent.py",
    "service/agent/play.py": "played in tests/service/agent/test_run.py and test_replay.py",
    "service/requests/agent.py": "fields only; read in tests/service/agent",
    "simulator/agent/agent.py": "asked over HTTP in tests/simulator/agent/test_http.py",
    "simulator/agent/documents.py": "held against the schemas in test_http.py",
    "simulator/agent/names.py": "names only; chosen in test_machine_model.py",
    "simulator/agent/requests.py": "asked over HTTP in test_http.py",
    "simulator/agent/selection.py": "asked over HTTP in test_http.py",
    "simulator/agent/machine_feed.py": "heard by a client in tests/service/agent/test_run.py",
    "service/requests/runs.py": "fields only; read in rest/test_bodies.py and storage",
    "service/trial/request.py": "fields only; read in rest/test_bodies.py and storage",
    "service/requests/knowledge.py": "fields only; read in rest/test_bodies.py and storage",
    "stepnc_model/file_profile.py": "names only; chosen in test_writeback.py",
    "stepnc_model/toolpath/explicit/planned_path.py": "nouns; read in test_path_writer.py",
    "stepnc_model/post/dialect.py": "names only; chosen in test_dialects.py",
    "simulator/motion/model_name.py": "names only; chosen in test_control.py",
    "simulator/machine/noise_kind.py": "names only; chosen in test_disturbance.py",
    "simulator/reading.py": "made and read in tests/simulator/plant",
    "simulator/factory/crews.py": "claimed in tests/simulator/factory/test_station.py",
    "simulator/factory/floor.py": "run in test_station.py and test_queueing.py",
    "simulator/factory/machining.py": "drawn in tests/service/factory/test_factory.py",
    "simulator/factory/measured.py": "held against closed forms in test_queueing.py",
    "simulator/factory/records.py": "named tuples; told in test_station.py",
    "simulator/factory/shop.py": "dataclasses only; read in test_shop_file.py",
    "simulator/factory/shifts.py": "kept to in test_station.py",
    "simulator/factory/shop_tables.py": "refused in test_shop_file.py",
    "simulator/factory/states.py": "kept to in test_station.py",
    "simulator/factory/store.py": "held against closed forms in test_queueing.py",
    "simulator/factory/streams.py": "compared in test_station.py",
    "simulator/factory/surroundings.py": "dataclass only; met in test_station.py",
    "simulator/factory/tally.py": "added up in test_station.py",
    "simulator/factory/upkeep.py": "held against a closed form in test_queueing.py",
    "service/cli/factory.py": "run in tests/service/factory/test_factory.py",
    "service/execution/pools.py": "asked in tests/service/execution/test_cluster.py",
    "service/folder_advice/output.py": "printed in tests/service/folder_advice/test_cli.py",
    "service/factory/figures.py": "drawn in tests/service/factory/test_factory.py",
    "service/factory/output.py": "printed in tests/service/factory/test_factory.py",
    "service/factory/parts_file.py": "read in tests/service/factory/test_factory.py",
    "service/factory/plan.py": "run in tests/service/factory/test_factory.py",
    "service/factory/replications.py": "compared in tests/service/factory/test_factory.py",
    "service/factory/run.py": "run in tests/service/factory/test_factory.py",
    "service/factory/states_file.py": "read in tests/service/factory/test_factory.py",
    "service/factory/sweep.py": "compared in tests/service/factory/test_factory.py",
    "service/requests/factory.py": "fields only; read in tests/service/factory",
    "service/growing_file.py": "broken off in tests/service/test_run_file.py",
    "stepnc_model/part21/values.py": "written and read in tests/stepnc_model/part21",
    "stepnc_model/nc/advice.py": "written in nc/test_rewrite.py",
    "stepnc_model/nc/arcs.py": "held against LinuxCNC in nc/test_rs274.py",
    "stepnc_model/nc/block_edit.py": "its blocks are read in nc/test_rewrite.py",
    "stepnc_model/nc/block_words.py": "read in nc/test_program.py",
    "stepnc_model/nc/drilling.py": "held against the strict readers in nc/test_program.py",
    "stepnc_model/nc/feed_rows.py": "followed in nc/test_rewrite.py",
    "stepnc_model/nc/flow_keywords.py": "followed in nc/test_macros.py",
    "stepnc_model/nc/iso_motions.py": "tables; read in nc/test_program.py",
    "stepnc_model/nc/flow.py": "repeated and called in nc/test_program.py",
    "stepnc_model/nc/heidenhain_control.py": "read in nc/test_program.py",
    "stepnc_model/nc/iso_codes.py": "tables; read in nc/test_program.py",
    "stepnc_model/nc/iso_control.py": "held against LinuxCNC in nc/test_rs274.py",
    "stepnc_model/nc/iso_flow.py": "repeated and called in nc/test_program.py",
    "stepnc_model/nc/iso_modes.py": "held against LinuxCNC in nc/test_rs274.py",
    "stepnc_model/nc/klartext_words.py": "read in nc/test_program.py",
    "stepnc_model/nc/moves.py": "columns; read in nc/test_program.py",
    "stepnc_model/nc/neutral_blocks.py": "compared in nc/test_program.py",
    "stepnc_model/nc/number_style.py": "written in nc/test_rewrite.py",
    "stepnc_model/nc/recognise.py": "guessed in nc/test_program.py",
    "stepnc_model/nc/recorder.py": "filled in nc/test_program.py",
    "stepnc_model/nc/remarks.py": "found in nc/test_program.py",
    "stepnc_model/nc/sinumerik_control.py": "read in nc/test_program.py",
    "stepnc_model/nc/split.py": "its pieces lie on their arcs in nc/test_rs274.py",
    "service/code_contents_output.py": "printed in tests/service/test_code_contents.py",
}
"""modules that are tested through another"""


def modules() -> list[str]:
    return sorted(
        str(path.relative_to(ROOT))
        for package in PACKAGES
        for path in (ROOT / package).rglob("*.py")
        if path.name != "__init__.py"
    )


@pytest.mark.parametrize("module", modules())
def test_module_has_a_mirror(module: str) -> None:
    path = Path(module)
    if str(path.parent) in NOUNS or module in TOGETHER:
        return
    assert (ROOT / "tests" / path.parent / f"test_{path.name}").exists()


@pytest.mark.parametrize("module", modules())
def test_module_is_short_enough_to_read(module: str) -> None:
    assert len((ROOT / module).read_text(encoding="utf-8").splitlines()) <= 500
