"""What is written is what was advised, in the units of the file."""

from pathlib import Path

import pytest

from service.verbs.optimise.program import advise_program as optimise
from stepnc_model.editing import writeback
from stepnc_model.editing.record import AdviceRecord
from stepnc_model.entities.tools import MillingCuttingTool, MillingToolBody
from stepnc_model.programs.program import Program
from stepnc_model.programs.technology import programmed
from tests.asking import asked_advice

PARTS = Path(__file__).parents[3] / "examples" / "parts"


def written(name: str, folder: Path, **options: str) -> tuple[Program, dict[int, AdviceRecord]]:
    output = folder / "out.stpnc"
    optimise(*asked_advice(file=PARTS / f"{name}.stpnc", output=output, **options))  # type: ignore[arg-type]
    program = Program.load(output)
    return program, writeback.records(program)


def test_paper_002_is_written_with_its_table_2(tmp_path: Path) -> None:
    program, records = written("paper002", tmp_path, machine="paper002")
    record = records[40]
    assert record.machine_power == 0.29
    assert record.cutting_power == pytest.approx(0.261)
    assert record.specific_cutting_resistance == pytest.approx(1000.0)
    assert record.feed_per_tooth == pytest.approx(0.117137, rel=1e-4)
    assert record.cutting_force == pytest.approx(447.429, rel=1e-4)
    assert (record.contact_angle, record.immersion) == (180.0, "FULL_IMMERSION")
    assert record.programmed_feedrate_per_tooth == 0.05
    conditions = programmed(program, program.workingsteps[0].technology_ref)
    assert conditions.feed.value == pytest.approx(record.feed_per_tooth)


@pytest.mark.parametrize("free", ["feed,depth", "feed,depth,speed"])
@pytest.mark.parametrize("name", ["bracket", "shaft"])
def test_the_file_runs_at_the_recorded_feed_and_speed(
    name: str, free: str, tmp_path: Path
) -> None:
    program, records = written(name, tmp_path, free=free)
    checked = 0
    for step in program.workingsteps:
        record = records.get(int(step.operation_ref))
        if record is None or name == "shaft":
            continue
        conditions = programmed(program, step.technology_ref)
        tool = program.get(step.tool_ref)
        assert isinstance(tool, MillingCuttingTool)
        body = program.get(tool.its_tool_body)
        assert isinstance(body, MillingToolBody)
        diameter = program.get(body.dimension).diameter
        speed = conditions.spindle_speed(diameter)
        assert speed == pytest.approx(abs(record.spindle_speed))
        feed = conditions.feed_per_tooth(speed, body.number_of_teeth or 1)
        assert feed == pytest.approx(record.feed_per_tooth)
        checked += 1
    assert checked or name == "shaft"
    assert len(records) >= 5


def test_a_lathe_keeps_the_sign_of_its_spindle(tmp_path: Path) -> None:
    _, records = written("shaft", tmp_path)
    assert all(record.spindle_speed > 0.0 for record in records.values())
    assert all(record.immersion is None for record in records.values())
