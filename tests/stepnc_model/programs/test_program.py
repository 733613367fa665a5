"""A program is walked in order; what makes a workingstep unusable is a fault with its place."""

from pathlib import Path
from typing import Any

import pytest

from stepnc_model.errors import Part21Error, SchemaError, Severity
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program, ResolvedWorkingstep
from stepnc_model.units import PROFILES

PARTS = Path(__file__).parents[3] / "examples" / "parts"

HEADER = "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('MACHINING_SCHEMA'));\nENDSEC;\nDATA;\n"
FIRST_LINE = 6
"""of the DATA section's instances"""

PROJECT = "#1=PROJECT('P',#2,(),$,$,$);"
COMMON = (
    "#60=ROUND_HOLE('H',$,(),$,$,$,$,$);",
    "#61=MILLING_CUTTING_TOOL('T',#62,(),$,$,$);",
    "#62=TWIST_DRILL(#63,2,.RIGHT.,.F.,$);",
    "#63=MILLING_TOOL_DIMENSION(8.,$,$,$,$,$,$);",
    "#64=MILLING_TECHNOLOGY(0.003,.TCP.,$,-40.,$,.F.,.F.,.F.,$);",
    "#65=MILLING_MACHINE_FUNCTIONS(.T.,$,$,.F.,$,(),.T.,$,$,());",
    "#66=DRILLING($,$,'OP',5.,$,#61,#64,#65,$,$,$,$,$,$);",
    "#70=NC_VARIABLE('V',$);",
    "#71=COMPARISON_EQUAL(#70,#72);",
    "#72=NC_CONSTANT('C',1.);",
)


def program_of(*instances: str) -> Program:
    body = "\n".join(instances)
    text = f"{HEADER}{body}\nENDSEC;\nEND-ISO-10303-21;\n"
    return Program(Part21File.from_bytes(text.encode()))


def plan(id: int, *elements: int, setup: str = "$") -> str:
    inner = ",".join(f"#{element}" for element in elements)
    return f"#{id}=WORKPLAN('PLAN {id}',({inner}),$,{setup},$);"


def step(id: int, operation: str = "#66") -> str:
    return f"#{id}=MACHINING_WORKINGSTEP('STEP {id}',$,#60,{operation},$);"


def ids(program: Program) -> list[int]:
    return [int(executable.ref) for executable in program.executables]


def only_fault(program: Program) -> SchemaError:
    (fault,) = program.faults
    return fault


class TestOrder:
    def test_nested_workplans_run_in_order(self) -> None:
        program = program_of(
            PROJECT,
            plan(2, 10, 3, 13),
            plan(3, 4, 12),
            plan(4, 11),
            *map(step, (13, 12, 11, 10)),
            *COMMON,
        )
        assert ids(program) == [2, 10, 3, 4, 11, 12, 13]
        assert [executable.level for executable in program.executables] == [
            0, 1, 1, 2, 3, 2, 1,
        ]  # fmt: skip
        assert [int(each.ref) for each in program.workingsteps] == [10, 11, 12, 13]

    @pytest.mark.parametrize(
        ("structure", "runs"),
        [
            ("#5=PARALLEL('S',(#10,#11));", 2),
            ("#5=NON_SEQUENTIAL('S',(#10,#11));", 2),
            ("#5=SELECTIVE('S',(#10,#11));", 0),
            ("#5=IF_STATEMENT('S',#71,#10,#11);", 0),
        ],
    )
    def test_a_structure_comes_before_what_it_contains(self, structure: str, runs: int) -> None:
        program = program_of(PROJECT, plan(2, 5), structure, step(10), step(11), *COMMON)
        assert ids(program) == [2, 5, 10, 11]
        assert len(program.workingsteps) == runs
        assert len(program.faults) == (runs == 0)

    def test_a_choice_names_what_it_chooses_from(self) -> None:
        choice = "#5=SELECTIVE('S',(#10,#11));"
        program = program_of(PROJECT, plan(2, 5), choice, step(10), step(11), *COMMON)
        assert "#10 'STEP 10' or #11 'STEP 11'" in str(only_fault(program))
        assert '--set "#5.its_elements=(#10)"' in str(only_fault(program))

    def test_a_choice_of_one_is_none(self) -> None:
        program = program_of(PROJECT, plan(2, 5), "#5=SELECTIVE('S',(#10));", step(10), *COMMON)
        assert len(program.workingsteps) == 1

    def test_a_loop_runs_as_often_as_its_condition_holds(self) -> None:
        # N = 0, M = 1: the body sets N to M, M to 2, so that N < 2 holds twice.
        program = program_of(
            PROJECT,
            plan(2, 5, 11),
            "#5=WHILE_STATEMENT('S',#80,#6);",
            plan(6, 10, 7, 8),
            "#7=ASSIGNMENT('N',#81,#82);",
            "#8=ASSIGNMENT('M',#82,#83);",
            "#80=COMPARISON_LESS(#81,#83);",
            "#81=NC_VARIABLE('N',0.);",
            "#82=NC_VARIABLE('M',1.);",
            "#83=NC_CONSTANT('TWO',2.);",
            *map(step, (10, 11)),
            *COMMON,
        )
        assert ids(program) == [2, 5, 6, 10, 7, 8, 6, 10, 7, 8, 11]
        assert [int(each.ref) for each in program.workingsteps] == [10, 10, 11]
        assert [each.index for each in program.workingsteps] == [0, 1, 2]

    def test_a_loop_without_end_is_refused(self) -> None:
        with pytest.raises(SchemaError, match="more than 100000 executables"):
            program_of(
                PROJECT,
                plan(2, 5),
                "#5=WHILE_STATEMENT('S',#80,#10);",
                "#80=COMPARISON_EQUAL(#81,#81);",
                "#81=NC_VARIABLE('N',0.);",
                step(10),
                *COMMON,
            )

    def test_an_if_without_else_has_one_branch(self) -> None:
        program = program_of(
            PROJECT, plan(2, 5), "#5=IF_STATEMENT('S',#71,#10,$);", step(10), *COMMON
        )
        assert ids(program) == [2, 5, 10]

    def test_an_assignment_is_kept_and_machines_nothing(self) -> None:
        program = program_of(
            PROJECT, plan(2, 5, 10), "#5=ASSIGNMENT('S',#70,#72);", step(10), *COMMON
        )
        assert [each.keyword for each in program.executables] == [
            "WORKPLAN",
            "ASSIGNMENT",
            "MACHINING_WORKINGSTEP",
        ]
        assert len(program.workingsteps) == 1

    def test_a_function_of_the_control_is_kept(self) -> None:
        program = program_of(
            PROJECT, plan(2, 5, 10), "#5=OPTIONAL_STOP('LOOK');", step(10), *COMMON
        )
        assert [each.id for each in program.executables] == ["PLAN 2", "LOOK", "STEP 10"]

    def test_a_workingstep_that_runs_twice_is_there_twice(self) -> None:
        program = program_of(PROJECT, plan(2, 10, 10), step(10), *COMMON)
        assert [int(each.ref) for each in program.workingsteps] == [10, 10]

    def test_ten_thousand_nested_workplans_are_no_recursion(self) -> None:
        depth = 10_000
        plans = [plan(number, number + 1) for number in range(1000, 1000 + depth)]
        program = program_of(
            "#1=PROJECT('P',#1000,(),$,$,$);", *plans, step(1000 + depth), *COMMON
        )
        assert program.executables[-1].level == depth

    def test_the_setup_is_that_of_the_innermost_workplan_that_has_one(self) -> None:
        program = program_of(
            PROJECT,
            plan(2, 10, 3, 13, setup="#80"),
            plan(3, 4, 12, setup="#81"),
            plan(4, 11),
            *map(step, (10, 11, 12, 13)),
            "#80=SETUP('A',$,$,());",
            "#81=SETUP('B',$,$,());",
            *COMMON,
        )
        setups = [each.setup for each in program.workingsteps]
        assert setups == [Ref(80), Ref(81), Ref(81), Ref(80)]

    def test_the_last_workingstep_on_a_feature_leaves_its_surface(self) -> None:
        program = program_of(PROJECT, plan(2, 10, 11), step(10), step(11), *COMMON)
        assert [each.is_last_on_feature for each in program.workingsteps] == [False, True]


class TestRefusal:
    def test_a_circle_of_workplans_names_the_instance(self) -> None:
        with pytest.raises(SchemaError) as caught:
            program_of(PROJECT, plan(2, 3), plan(3, 4), plan(4, 3))
        assert caught.value.entity == "#3 WORKPLAN"
        assert caught.value.attribute == "its_elements"
        assert caught.value.line == FIRST_LINE + 2

    def test_a_workplan_in_itself_names_the_instance(self) -> None:
        with pytest.raises(SchemaError, match=r"#2 WORKPLAN.*contains itself"):
            program_of(PROJECT, plan(2, 2))

    def test_a_project_without_main_workplan_is_refused(self) -> None:
        with pytest.raises(SchemaError) as caught:
            program_of("#1=PROJECT('P',$,(),$,$,$);", plan(2))
        assert caught.value.entity == "#1 PROJECT"
        assert caught.value.attribute == "main_workplan"
        assert caught.value.line == FIRST_LINE

    def test_a_main_workplan_that_is_not_there_is_refused(self) -> None:
        with pytest.raises(SchemaError, match=r"#2.*does not exist"):
            program_of(PROJECT)

    def test_a_main_workplan_of_another_kind_is_refused(self) -> None:
        with pytest.raises(SchemaError, match="is not a workplan"):
            program_of(PROJECT, "#2=NC_VARIABLE('V',$);")

    def test_a_file_without_project_runs_its_only_outer_workplan(self) -> None:
        program = program_of(plan(2, 3), plan(3, 10), step(10), *COMMON)
        assert ids(program) == [2, 3, 10]

    def test_two_outer_workplans_without_project_are_refused(self) -> None:
        with pytest.raises(SchemaError, match="2 workplans that are not nested"):
            program_of(plan(2), plan(3))

    def test_a_file_without_workplan_is_no_program(self) -> None:
        with pytest.raises(SchemaError, match="0 workplans"):
            program_of("#1=CARTESIAN_POINT('',(0.,0.,0.));")

    def test_bytes_that_are_no_part_21_are_refused(self, tmp_path: Path) -> None:
        path = tmp_path / "text.stpnc"
        path.write_bytes(b"no exchange structure")
        with pytest.raises(Part21Error):
            Program.load(path)


class TestFault:
    @pytest.mark.parametrize(
        ("tool", "technology", "attribute", "message"),
        [
            ("$", "#64", "its_tool", "has no tool"),
            ("#61", "$", "its_technology", "has no technology"),
        ],
    )
    def test_an_operation_that_lacks_something_is_a_fault_with_line_and_attribute(
        self, tool: str, technology: str, attribute: str, message: str
    ) -> None:
        program = program_of(
            PROJECT,
            plan(2, 10, 11),
            step(10, "#20"),
            f"#20=DRILLING($,$,'BAD',5.,$,{tool},{technology},#65,$,$,$,$,$,$);",
            step(11),
            *COMMON,
        )
        fault = only_fault(program)
        assert fault.entity == "#20 DRILLING"
        assert fault.attribute == attribute
        assert fault.line == FIRST_LINE + 3
        assert message in str(fault)
        assert [int(each.ref) for each in program.workingsteps] == [11]

    def test_a_dangling_tool_is_a_fault_and_a_finding_with_line_and_attribute(self) -> None:
        program = program_of(
            PROJECT,
            plan(2, 10),
            step(10, "#20"),
            "#20=DRILLING($,$,'BAD',5.,$,#999,#64,#65,$,$,$,$,$,$);",
            *COMMON,
        )
        assert "#999" in str(only_fault(program))
        found = [each for each in program.findings() if each.attribute == "its_tool"]
        (finding,) = found
        assert finding.severity is Severity.ERROR
        assert finding.entity == "#20 DRILLING"
        assert finding.line == FIRST_LINE + 3

    def test_a_workingstep_without_operation_is_a_fault(self) -> None:
        program = program_of(PROJECT, plan(2, 10), step(10, "$"), *COMMON)
        fault = only_fault(program)
        assert (fault.entity, fault.attribute, fault.line) == (
            "#10 MACHINING_WORKINGSTEP",
            "its_operation",
            FIRST_LINE + 2,
        )

    def test_an_operation_of_another_kind_is_a_fault(self) -> None:
        program = program_of(PROJECT, plan(2, 10), step(10, "#70"), *COMMON)
        assert "#70 NC_VARIABLE: is not a machining operation" in str(only_fault(program))

    def test_an_unknown_operation_is_a_fault_that_names_it(self) -> None:
        program = program_of(
            PROJECT, plan(2, 10), step(10, "#20"), "#20=LASER_MELTING($);", *COMMON
        )
        fault = only_fault(program)
        assert (fault.entity, fault.line) == ("#20 LASER_MELTING", FIRST_LINE + 3)

    def test_faults_are_findings_of_severity_error(self) -> None:
        program = program_of(PROJECT, plan(2, 10), step(10, "$"), *COMMON)
        errors = [each for each in program.findings() if each.severity is Severity.ERROR]
        assert any(each.entity == "#10 MACHINING_WORKINGSTEP" for each in errors)


class TestWorkingstep:
    def test_it_knows_what_it_refers_to(self) -> None:
        program = program_of(PROJECT, plan(2, 10), step(10), *COMMON)
        (found,) = program.workingsteps
        assert isinstance(found, ResolvedWorkingstep)
        assert (found.tool_ref, found.technology_ref) == (Ref(61), Ref(64))
        assert (found.operation_ref, found.functions_ref) == (Ref(66), Ref(65))
        assert (found.features, found.operation_type) == ((Ref(60),), "drilling")

    def test_a_turning_workingstep_has_several_features(self) -> None:
        program = Program.load(PARTS / "shaft.stpnc")
        assert max(len(each.features) for each in program.workingsteps) > 1

    def test_a_label_and_a_line_name_an_instance(self) -> None:
        program = program_of(PROJECT, plan(2))
        assert program.label(Ref(2)) == "#2 WORKPLAN"
        assert program.line(Ref(2)) == FIRST_LINE + 1


class TestWorkpiece:
    def test_the_material_is_that_of_the_projects_workpiece(self) -> None:
        program = program_of(
            "#1=PROJECT('P',#2,(#31),$,$,$);",
            plan(2),
            "#30=WORKPIECE('OTHER',#40,$,$,$,$,());",
            "#31=WORKPIECE('MINE',#41,$,$,$,$,());",
            "#40=MATERIAL('A','',());",
            "#41=MATERIAL('B','',());",
        )
        material = program.material()
        assert material is not None
        assert material.standard_identifier == "B"

    def test_what_is_no_material_is_refused(self) -> None:
        program = program_of(PROJECT, plan(2), "#30=WORKPIECE('MINE',#2,$,$,$,$,());")
        with pytest.raises(SchemaError, match=r"#2 WORKPLAN: is not a material"):
            program.material()

    def test_a_file_without_workpiece_has_no_material(self) -> None:
        program = program_of(PROJECT, plan(2))
        assert program.workpiece() is None
        assert program.material() is None


def test_the_samples_load_without_fault() -> None:
    for path in sorted(PARTS.glob("*.stpnc")):
        assert Program.load(path).faults == ()


def test_a_loaded_program_knows_its_name_and_units() -> None:
    program = Program.load(PARTS / "bracket.stpnc", units=PROFILES["rpm-mmin"])
    assert (program.name, program.units.name) == ("bracket.stpnc", "rpm-mmin")


def test_an_executable_that_no_entity_describes_is_kept_and_shown() -> None:
    data = (PARTS / "paper002.stpnc").read_bytes()
    data = data.replace(b"(#3),$,#20,$", b"(#3,#4),$,#20,$")
    data = data.replace(b"\n#10=", b"\n#4=COFFEE_BREAK('FIVE MINUTES');\n#10=", 1)
    program = Program(Part21File.from_bytes(data))
    assert [each.keyword for each in program.executables][-1] == "COFFEE_BREAK"
    assert len(program.workingsteps) == 1
    assert any("COFFEE_BREAK" in finding.message for finding in program.findings())


class TestMistakesOfTheCode:
    """Errors that no value of a file can cause are not told as faults of the file."""

    def program(self) -> Program:
        part = Path(__file__).parents[3] / "examples" / "parts" / "paper002.stpnc"
        return Program.load(part)

    def test_a_mistyped_attribute_of_an_own_object_passes(self) -> None:
        program = self.program()
        step: Any = program.workingsteps[0]
        with pytest.raises(AttributeError), program.using(step.ref):
            _ = step.operaton

    def test_a_wrong_call_passes_where_the_file_has_no_fault(self) -> None:
        program = self.program()
        step: Any = program.workingsteps[0]
        with pytest.raises(TypeError), program.using(step.technology_ref):
            len(3)  # type: ignore[arg-type]

    def test_a_value_that_is_not_given_is_a_fault_of_the_file(self) -> None:
        program = self.program()
        missing: Any = None
        ref = program.workingsteps[0].ref
        with pytest.raises(SchemaError, match="line"), program.using(ref):
            _ = missing.x
        with pytest.raises(SchemaError, match="line"), program.using(ref):
            _ = missing * 2.0
