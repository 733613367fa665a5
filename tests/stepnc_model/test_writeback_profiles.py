"""What is written for turning, and in either profile."""

import pytest

from stepnc_model.editing import writeback
from stepnc_model.editing.file_profile import FileProfile
from stepnc_model.editing.record import PREFIX
from stepnc_model.editing.record_edit import RECORD_KEYWORDS
from stepnc_model.editing.writeback import SCHEMA
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref
from stepnc_model.programs.technology import programmed
from tests.stepnc_model.written import (
    PARTS_NAMES,
    PROFILES,
    added,
    change_of,
    changed,
    converted,
    ex1,
    instances,
    optimised,
    part,
    program_of,
    write_first,
)


class TestTurning:
    def test_the_depth_goes_to_the_strategy(self) -> None:
        program = program_of(part("shaft"))
        step = next(each for each in program.workingsteps if int(each.operation_ref) == 202)
        data = writeback.write(
            program, [change_of(program, step, depth=1.25)], FileProfile.STANDARD
        )
        edits = changed(part("shaft"), data)
        assert edits.keys() == {352}
        assert edits[352] == (
            b"#352=UNIDIRECTIONAL_TURNING(1.,.T.,(1.25),$,#504,#501,#502,#506,1.,$,$);"
        )

    def test_a_shared_strategy_is_copied_first(self) -> None:
        before = part("shaft").replace(b"#330,$,$,#351,0.);", b"#330,$,$,#350,0.);")
        assert before != part("shaft")
        program = program_of(before)
        data = writeback.write(
            program,
            [change_of(program, program.workingsteps[0], depth=1.25)],
            FileProfile.STANDARD,
        )
        assert instances(data)[350] == instances(before)[350]
        assert instances(data)[201] == instances(before)[201]
        copies = [text for text in added(before, data).values() if b"(1.25)" in text]
        assert len(copies) == 1

    def test_a_speed_goes_to_a_copy_of_the_shared_speed(self) -> None:
        before = part("shaft")
        program = program_of(before)
        data = writeback.write(
            program,
            [change_of(program, program.workingsteps[0], speed=2.0)],
            FileProfile.STANDARD,
        )
        after = program_of(data)
        assert instances(data)[310] == instances(before)[310]
        speeds = [
            programmed(after, step.technology_ref).speed.value for step in after.workingsteps
        ]
        old = [
            programmed(program, step.technology_ref).speed.value
            for step in program.workingsteps
        ]
        assert speeds == [2000.0, *old[1:]]


class TestProfiles:
    @pytest.mark.parametrize("name", PARTS_NAMES)
    def test_standard_has_no_entities_of_the_optimisation(self, name: str) -> None:
        data = optimised(part(name), FileProfile.STANDARD)
        self.assert_standard(data, before=part(name))

    def test_ex1_as_standard_has_none_either(self) -> None:
        self.assert_standard(optimised(ex1(), FileProfile.STANDARD), before=ex1())

    @staticmethod
    def assert_standard(data: bytes, *, before: bytes) -> None:
        file = Part21File.from_bytes(data)
        own = RECORD_KEYWORDS - {"NUMERIC_PARAMETER"}
        assert not [keyword for keyword in own if file.ids_of(keyword)]
        assert SCHEMA.encode() not in data
        assert file.schemas == Part21File.from_bytes(before).schemas
        assert writeback.records(program_of(data))

    @pytest.mark.parametrize("name", PARTS_NAMES)
    def test_an_operation_has_no_surplus_parameter_in_the_standard(self, name: str) -> None:
        data = optimised(part(name), FileProfile.STANDARD)
        before = Part21File.from_bytes(part(name))
        after = Part21File.from_bytes(data)
        for id in before.ids():
            assert len(after.parameters(id)) == len(before.parameters(id))

    @pytest.mark.parametrize("name", PARTS_NAMES)
    def test_standard_parameters_are_prefixed(self, name: str) -> None:
        before = part(name)
        new = added(before, optimised(before, FileProfile.STANDARD)).values()
        parameters = [text for text in new if b"_PARAMETER(" in text]
        assert parameters
        assert all(f"('{PREFIX}".encode() in text for text in parameters)

    @pytest.mark.parametrize("name", PARTS_NAMES)
    def test_optimisation_names_its_schema_last(self, name: str) -> None:
        data = optimised(part(name), FileProfile.OPTIMISATION)
        old = Part21File.from_bytes(part(name)).schemas
        assert Part21File.from_bytes(data).schemas == (*old, SCHEMA)

    @pytest.mark.parametrize("profile", PROFILES)
    @pytest.mark.parametrize("name", PARTS_NAMES)
    def test_what_is_written_has_no_new_warning(self, name: str, profile: FileProfile) -> None:
        after = program_of(optimised(part(name), profile))
        before = program_of(part(name))
        assert [each.message for each in after.findings()] == [
            each.message for each in before.findings()
        ]

    def test_a_process_model_of_the_file_is_kept(self) -> None:
        model = b"#96=PROCESS_MODEL_LIST((#97));\n#97=PROCESS_MODEL('mine.ini','force');\n"
        functions = b"#42=MILLING_MACHINE_FUNCTIONS(.T.,$,$,.F.,$,(),.T.,$,$,());"
        with_model = functions.replace(b"$,());", b"#96,());")
        before = part("paper002").replace(functions, model + with_model)
        after = write_first(before, FileProfile.STANDARD, feed=0.125)
        assert len(Part21File.from_bytes(after).ids_of("PROCESS_MODEL")) == 1
        back = converted(converted(after, FileProfile.OPTIMISATION), FileProfile.OPTIMISATION)
        assert instances(back)[97] == b"#97=PROCESS_MODEL('mine.ini','force');"

    def test_other_functions_of_the_file_are_kept(self) -> None:
        functions = b"#42=MILLING_MACHINE_FUNCTIONS(.T.,$,$,.F.,$,(),.T.,$,$,());"
        mine = functions.replace(b"());", b"(#96));") + b"\n#96=DESCRIPTIVE_PARAMETER('a','b');"
        before = part("paper002").replace(functions, mine)
        after = write_first(before, FileProfile.STANDARD, feed=0.125)
        program = program_of(after)
        (step,) = program.workingsteps
        assert step.functions_ref is not None
        other = program.file.parameters(int(step.functions_ref))[-1]
        assert isinstance(other, tuple)
        assert other[0] == Ref(96)
        back = converted(after, FileProfile.OPTIMISATION)
        assert b"#96=DESCRIPTIVE_PARAMETER('a','b');" in back
        assert instances(back)[42] == mine.split(b"\n")[0]

    def test_without_advice_nothing_is_written(self) -> None:
        for name in PARTS_NAMES:
            program = program_of(part(name))
            assert writeback.write(program, [], FileProfile.OPTIMISATION) == part(name)


def test_a_file_without_records_has_none() -> None:
    for name in PARTS_NAMES:
        assert writeback.records(program_of(part(name))) == {}
