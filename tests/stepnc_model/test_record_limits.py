"""A record in the file is an input: its limits bound the next plan, the optimum does not."""

from dataclasses import replace
from pathlib import Path

import pytest

from service.verbs.optimise.plan_result import ProgramAdvice
from service.verbs.optimise.program import advise_program as optimise
from stepnc_model.editing.record import AdviceRecord
from stepnc_model.editing.record_edit import NO_LIMITS, RecordLimits, find_record, record_limits
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from tests.asking import asked_advice
from tests.stepnc_model.editing.test_record import RECORD

FIGURE = Path(__file__).parents[1] / "data" / "fig11.stpnc"
PART = Path(__file__).parents[2] / "examples" / "parts" / "paper002.stpnc"
LIMITS = RecordLimits(motor_power=290.0, feed_per_tooth=0.5, axial_depth=3.0)

POWER = b"#201= MACHINE_POWER('MACHINE POWER',0.29, 'kW');"
AS_IN_THE_SCHEMA = (
    b"#201= MACHINE_POWER(#205);\n#205= NUMERIC_PARAMETER('MACHINE POWER',290.,'W');"
)


def program_of(data: bytes) -> Program:
    return Program(Part21File.from_bytes(data))


def limits(data: bytes) -> RecordLimits:
    program = program_of(data)
    return record_limits(program, program.workingsteps[0])


def record(data: bytes) -> AdviceRecord:
    program = program_of(data)
    found = find_record(program, program.workingsteps[0])
    assert found is not None
    return found


def advised(
    file: Path, output: Path, *, ignore: bool = False, mode: str = "TC"
) -> ProgramAdvice:
    request, files = asked_advice(
        file=file, output=output, machine="vmc15", material="c45", mode=mode
    )
    return optimise(replace(request, ignore_record=ignore), files)


class TestPaper:
    def test_figure_11_gives_power_feed_and_depth(self) -> None:
        assert limits(FIGURE.read_bytes()) == LIMITS

    def test_the_form_of_the_schema_gives_the_same(self) -> None:
        data = FIGURE.read_bytes()
        assert POWER in data
        assert limits(data.replace(POWER, AS_IN_THE_SCHEMA)) == LIMITS

    @pytest.mark.parametrize("unit", [b"'hp'", b"''"])
    def test_a_power_in_another_unit_does_not_bind(self, unit: bytes) -> None:
        data = FIGURE.read_bytes().replace(b"0.29, 'kW'", b"0.29, " + unit)
        assert limits(data) == replace(LIMITS, motor_power=None)

    @pytest.mark.parametrize("number", [b"-0.5", b"0.", b"$"])
    def test_a_number_that_is_no_limit_does_not_bind(self, number: bytes) -> None:
        data = FIGURE.read_bytes().replace(b"'ROUGHING', 0.5", b"'ROUGHING', " + number)
        assert limits(data).feed_per_tooth is None

    def test_quality_gives_no_maxima(self) -> None:
        data = FIGURE.read_bytes().replace(b"TIME_CRITICAL", b"QUALITY_CRITICAL")
        assert limits(data) == RecordLimits(motor_power=290.0)

    def test_a_file_without_record_has_no_limits(self) -> None:
        assert limits(PART.read_bytes()) == NO_LIMITS
        assert not NO_LIMITS

    def test_words_have_units(self) -> None:
        text = "motor power 0.29 kW, feed per tooth 0.5 mm, axial depth 3 mm"
        assert LIMITS.words == text


class TestPlan:
    def test_the_power_of_the_record_bounds_the_plan(self, tmp_path: Path) -> None:
        found = advised(FIGURE, tmp_path / "a.stpnc")
        (advice,) = found.plan.advices
        assert advice.after is not None
        power = advice.after.motor_power * advice.safety_factor
        assert power == pytest.approx(290.0, rel=1e-6)
        assert advice.after.setting.depth <= 3.0
        assert any("kept: the record in the file" in f.message for f in found.plan.findings)

    @pytest.mark.parametrize(
        ("old", "new", "name"),
        [
            (b"'ROUGHING', 0.5, 3", b"'ROUGHING', 0.03, 3", "feed"),
            (b"'ROUGHING', 0.5, 3", b"'ROUGHING', 0.5, 0.4", "depth"),
        ],
    )
    def test_feed_and_depth_bound_it_too(
        self, old: bytes, new: bytes, name: str, tmp_path: Path
    ) -> None:
        part = tmp_path / "part.stpnc"
        part.write_bytes(FIGURE.read_bytes().replace(old, new).replace(b"0.29", b"9.9"))
        (advice,) = advised(part, tmp_path / "a.stpnc").plan.advices
        assert advice.after is not None
        bound = {"feed": 0.03, "depth": 0.4}[name]
        assert getattr(advice.after.setting, name) <= bound * (1.0 + 1e-9)

    def test_it_can_be_ignored_which_is_said(self, tmp_path: Path) -> None:
        found = advised(FIGURE, tmp_path / "a.stpnc", ignore=True)
        (advice,) = found.plan.advices
        assert advice.after is not None
        assert advice.after.motor_power > 1000.0
        assert any("ignored as requested" in f.message for f in found.plan.findings)

    @pytest.mark.parametrize("mode", ["TC", "QC", "EC"])
    def test_optimising_twice_changes_nothing(self, mode: str, tmp_path: Path) -> None:
        one, two = tmp_path / "one.stpnc", tmp_path / "two.stpnc"
        advised(FIGURE, one, mode=mode)
        advised(one, two, mode=mode)
        assert two.read_bytes() == one.read_bytes()
        assert limits(one.read_bytes()) == LIMITS


class TestOwnRecord:
    def test_the_maximum_is_what_is_allowed_and_the_optimum_stands_beside_it(
        self, tmp_path: Path
    ) -> None:
        advised(FIGURE, tmp_path / "a.stpnc")
        data = (tmp_path / "a.stpnc").read_bytes()
        found = record(data)
        assert (found.feed_per_tooth_max, found.axial_depth_max) == (0.5, 3.0)
        assert found.feed_per_tooth < 0.5
        assert b",0.5,3.,#" in data

    def test_without_limits_its_own_optimum_never_binds(self, tmp_path: Path) -> None:
        advised(PART, tmp_path / "a.stpnc")
        data = (tmp_path / "a.stpnc").read_bytes()
        assert limits(data) == NO_LIMITS
        found = record(data)
        assert found.feed_per_tooth_max is not None
        assert found.feed_per_tooth_max >= found.feed_per_tooth

    def test_a_record_of_before_is_recognised_and_does_not_bind(self, tmp_path: Path) -> None:
        """Its maxima are its optimum, and the last five attributes are missing."""
        advised(PART, tmp_path / "a.stpnc")
        data = (tmp_path / "a.stpnc").read_bytes()
        new = record(data)
        start = data.index(b"OPTIMISATION_RECORD(")
        end = data.index(b");", start)
        parts = data[start:end].split(b",")
        old = data[:start] + b",".join(parts[:-5]) + data[end:]
        assert limits(old) == NO_LIMITS
        found = record(old)
        assert found.feed_per_tooth == new.feed_per_tooth_max
        assert found.feed_per_tooth_max is None

    def test_a_damaged_own_record_does_not_bind(self, tmp_path: Path) -> None:
        advised(FIGURE, tmp_path / "a.stpnc")
        data = (tmp_path / "a.stpnc").read_bytes()
        damaged = data.replace(b"OPTIMISATION_RECORD(4,", b"OPTIMISATION_RECORD($,")
        assert damaged != data
        assert limits(damaged) == NO_LIMITS


def test_maxima_come_together_and_belong_to_time() -> None:
    with pytest.raises(ValueError, match="come together"):
        replace(RECORD, feed_per_tooth_max=0.5)
    with pytest.raises(ValueError, match="time critical"):
        replace(RECORD, mode="QC", feed_per_tooth_max=0.5, axial_depth_max=3.0)
