"""Units found by the numbers of a file: the right ones, or none.

Files are made with numbers of real shops in each unit profile. ``STEPNC_SEEDED`` sets how many
are made of each (``STEPNC_SEEDED=1000`` takes a minute).
"""

import os
from math import pi
from pathlib import Path
from random import Random

import pytest

from service.programs.reading import read_program
from stepnc_model.errors import SchemaError, StepNcError
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.plausibility import (
    proposal,
    refusal,
    unit_findings,
    units_by_numbers,
)
from stepnc_model.programs.program import Program
from stepnc_model.programs.technology import programmed
from stepnc_model.programs.tool import tool_of
from stepnc_model.units import ISO, PROFILES, FeedUnit, UnitProfile
from tests.checked import check

SEEDED = int(os.environ.get("STEPNC_SEEDED", "25"))
CORPUS = Path(__file__).parents[3] / "shared" / "corpus" / "iso14649"

FASTEST = 250.0
"""Spindle speed of a fast machining centre, rev/s."""

HEAD = "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('MACHINING_SCHEMA'));\nENDSEC;\nDATA;"
DRILL = "#{0}=DRILLING($,$,'OP',5.,$,#{1},#{2},#10,$,$,$,$,$,$);"
MILL = "#{0}=PLANE_ROUGH_MILLING($,$,'OP',5.,$,#{1},#{2},#10,$,$,$,$,2.,0.);"


def technology(rng: Random, units: UnitProfile, *, is_drill: bool, size: float, z: int) -> str:
    """A plausible technology of a tool, as a file in these units writes it."""
    speed = rng.uniform(15.0, 120.0) if is_drill else rng.uniform(30.0, 500.0)
    turning = min(speed * 1000.0 / 60.0 / (pi * size), FASTEST)
    speed = turning * pi * size * 60.0 / 1000.0
    per_turn = rng.uniform(0.008, 0.03) * size
    feed = per_turn if is_drill else rng.uniform(0.004, 0.012) * size * z
    used = units.for_drilling() if is_drill else units
    written = {
        FeedUnit.METRES_PER_SECOND: feed * turning / 1000.0,
        FeedUnit.MM_PER_MINUTE: feed * turning * 60.0,
        FeedUnit.MM_PER_TOOTH: feed / z,
        FeedUnit.MM_PER_REVOLUTION: feed,
    }[used.feed]
    spindle = turning / units.spindle
    cutspeed = speed * 1000.0 / 60.0 / units.cutting_speed
    both = rng.choice(("spindle", "cutspeed", "both"))
    first = "$" if both == "spindle" else f"{cutspeed:.9g}"
    second = "$" if both == "cutspeed" else f"{-spindle:.9g}"
    first, second = (
        each if "." in each or each == "$" else f"{each}." for each in (first, second)
    )
    number = f"{written:.6f}"
    return f"MILLING_TECHNOLOGY({number},.TCP.,{first},{second},$,.F.,.F.,.F.,$)"


def seeded(rng: Random, units: UnitProfile) -> Program:
    """A program of one to five workingsteps, read in the standard's units."""
    count = rng.randint(1, 5)
    lines = [HEAD, "#1=PROJECT('P',#2,(),$,$,$);"]
    steps = ",".join(f"#{100 * each}" for each in range(1, count + 1))
    lines.append(f"#2=WORKPLAN('W',({steps}),$,$,$);")
    lines.append("#10=MILLING_MACHINE_FUNCTIONS(.T.,$,$,.F.,$,(),.T.,$,$,());")
    for each in range(1, count + 1):
        at = 100 * each
        is_drill = rng.random() < 0.5
        size = round(rng.uniform(2.0, 20.0 if is_drill else 80.0), 1)
        z = 2 if is_drill else rng.choice((1, 2, 3, 4, 6))
        body = "TWIST_DRILL" if is_drill else "ENDMILL"
        written = technology(rng, units, is_drill=is_drill, size=size, z=z)
        lines += [
            f"#{at}=MACHINING_WORKINGSTEP('S{each}',$,#{at + 1},#{at + 2},$);",
            f"#{at + 1}=ROUND_HOLE('H',$,(),$,$,$,$,$);",
            (DRILL if is_drill else MILL).format(at + 2, at + 3, at + 6),
            f"#{at + 3}=MILLING_CUTTING_TOOL('T',#{at + 4},(),$,$,$);",
            f"#{at + 4}={body}(#{at + 5},{z},.RIGHT.,.F.,$);",
            f"#{at + 5}=MILLING_TOOL_DIMENSION({size},$,$,$,$,$,$);",
            f"#{at + 6}={written};",
        ]
    text = "\n".join([*lines, "ENDSEC;", "END-ISO-10303-21;"])
    return Program(Part21File.from_bytes(text.encode()))


def feeds(program: Program, units: UnitProfile) -> list[float]:
    """Feed per tooth of each workingstep in a unit profile, mm."""
    found = Program(program.file, units=units)
    numbers = []
    for step in found.workingsteps:
        tool = tool_of(found, step.tool_ref)
        told = programmed(found, step.technology_ref)
        turning = told.spindle_speed(tool.diameter)
        numbers.append(told.feed_per_tooth(turning, tool.teeth))
    return numbers


@pytest.mark.parametrize("name", PROFILES)
def test_units_are_found_right_or_not_at_all(name: str) -> None:
    units, rng = PROFILES[name], Random(f"units {name}")
    for _ in range(SEEDED):
        program = seeded(rng, units)
        try:
            chosen, _ = units_by_numbers(program, program.workingsteps)
        except SchemaError:
            continue
        assert feeds(program, chosen) == pytest.approx(feeds(program, units), rel=1e-6)


@pytest.mark.parametrize("name", [name for name in PROFILES if name != "iso"])
def test_a_proposal_is_right(name: str) -> None:
    """Where the standard cannot be meant and one profile fits, it is the one."""
    units, rng = PROFILES[name], Random(f"proposal {name}")
    for _ in range(SEEDED):
        program = seeded(rng, units)
        only = proposal(program, program.workingsteps).only
        if refusal(program, program.workingsteps) is not None and only is not None:
            assert feeds(program, only) == pytest.approx(feeds(program, units), rel=1e-6)


def program_in_rpm(feed: str = "240.") -> Program:
    text = "\n".join([
        HEAD,
        "#1=PROJECT('P',#2,(),$,$,$);",
        "#2=WORKPLAN('W',(#3),$,$,$);",
        "#3=MACHINING_WORKINGSTEP('S',$,#4,#5,$);",
        "#4=ROUND_HOLE('H',$,(),$,$,$,$,$);",
        DRILL.format(5, 7, 6),
        f"#6=MILLING_TECHNOLOGY({feed},.TCP.,$,-1200.,$,.F.,.F.,.F.,$);",
        "#7=MILLING_CUTTING_TOOL('T',#8,(),$,$,$);",
        "#8=TWIST_DRILL(#9,2,.RIGHT.,.F.,$);",
        "#9=MILLING_TOOL_DIMENSION(10.,$,$,$,$,$,$);",
        "#10=MILLING_MACHINE_FUNCTIONS(.T.,$,$,.F.,$,(),.T.,$,$,());",
        "ENDSEC;",
        "END-ISO-10303-21;",
    ])
    return Program(Part21File.from_bytes(text.encode()))


class TestProposal:
    def test_the_only_fitting_profile_is_proposed_with_its_numbers(self) -> None:
        program = program_in_rpm()
        found = proposal(program, program.workingsteps)
        assert found.only is PROFILES["rpm-mmin"]
        (evidence,) = found.evidence
        assert evidence.message == (
            "in units 'rpm-mmin': 1200 rpm, 37.7 m/min, 0.1 mm per tooth"
        )
        assert evidence.entity == "#6 MILLING_TECHNOLOGY"

    def test_the_finding_gives_the_option_to_type(self) -> None:
        first = unit_findings(program_in_rpm())[0]
        assert "all are plausible with --units rpm-mmin" in first.message

    def test_two_profiles_are_named_and_neither_is_taken(self) -> None:
        program = program_in_rpm("0.1")
        assert proposal(program, program.workingsteps).words == "rpm-mmtooth or rpm-mmrev"
        with pytest.raises(SchemaError, match="rpm-mmtooth or rpm-mmrev; name one of them"):
            units_by_numbers(program, program.workingsteps)

    def test_numbers_of_no_profile_are_refused(self) -> None:
        program = program_in_rpm("1.E12")
        with pytest.raises(SchemaError, match="no unit profile"):
            units_by_numbers(program, program.workingsteps)
        assert "nor in any other" in unit_findings(program)[0].message

    def test_plausible_numbers_need_no_proposal(self) -> None:
        program = program_in_rpm()
        other = Program(program.file, units=PROFILES["rpm-mmin"])
        assert unit_findings(other) == ()


class TestKindsOfOperation:
    """Per tooth in milling, per revolution in drilling, in one file."""

    @staticmethod
    def program() -> Program:
        rng = Random(4)
        while True:
            program = seeded(rng, PROFILES["rpm-mmtooth-mmrev"])
            kinds = {step.operation_type for step in program.workingsteps}
            if len(kinds) == 2:
                return Program(program.file, units=PROFILES["rpm-mmtooth-mmrev"])

    def test_each_kind_has_its_unit(self) -> None:
        program = self.program()
        for step in program.workingsteps:
            told = programmed(program, step.technology_ref).feed.quantity.value
            is_drill = step.operation_type == "drilling"
            assert told == ("feed per revolution" if is_drill else "feed per tooth")

    def test_a_technology_of_both_kinds_is_refused(self) -> None:
        text = self.program().file.data.decode()
        program = Program(
            Part21File.from_bytes(text.encode()), units=PROFILES["rpm-mmtooth-mmrev"]
        )
        drill = next(s for s in program.workingsteps if s.operation_type == "drilling")
        mill = next(s for s in program.workingsteps if s.operation_type != "drilling")
        shared = text.replace(f",{mill.technology_ref},#10", f",{drill.technology_ref},#10")
        program = Program(
            Part21File.from_bytes(shared.encode()), units=PROFILES["rpm-mmtooth-mmrev"]
        )
        with pytest.raises(SchemaError, match="drilling and milling share it"):
            programmed(program, drill.technology_ref)


class TestAuto:
    def test_the_choice_is_told_technology_by_technology(self, tmp_path: Path) -> None:
        path = tmp_path / "part.p21"
        path.write_bytes(program_in_rpm().file.data)
        told: list[str] = []
        program = read_program(path, units="auto", tell=told.append)
        assert program.units is PROFILES["rpm-mmin"]
        assert told[0].startswith("units: rpm-mmin")
        assert "#6 MILLING_TECHNOLOGY" in told[1]

    def test_check_proposes_units(self, tmp_path: Path) -> None:
        path = tmp_path / "part.p21"
        path.write_bytes(program_in_rpm().file.data)
        texts = [str(finding) for finding in check(path).findings]
        assert any("--units rpm-mmin" in text for text in texts)

    def test_ambiguous_units_are_refused(self, tmp_path: Path) -> None:
        path = tmp_path / "part.p21"
        path.write_bytes(program_in_rpm("0.1").file.data)
        with pytest.raises(StepNcError, match="name one of them"):
            read_program(path, units="auto")

    def test_the_standard_is_named_where_it_fits_too(self) -> None:
        path = CORPUS / "ex1.stp"
        if not path.exists():
            pytest.skip("ex1.stp is not beside the project")
        program = Program.load(path)
        with pytest.raises(SchemaError, match="iso is the standard"):
            units_by_numbers(program, program.workingsteps)
        assert program.units is ISO
