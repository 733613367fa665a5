"""One function per verb: what they read, refuse and write."""

from collections import Counter
from pathlib import Path

import pytest

import stepnc
from optimiser.advice import AdviceStatus
from service.programs.reading import read_program
from service.verbs.optimise import program as advising
from service.verbs.optimise.plan_result import ProgramAdvice
from simulator.errors import UnknownMachine, UnknownMaterial
from stepnc_model.editing.file_profile import FileProfile
from stepnc_model.errors import SchemaError, Severity, StepNcError, WriteError
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from tests.asking import AskedAdvice, asked_advice
from tests.checked import check

ROOT = Path(__file__).parents[4]
PARTS = ROOT / "examples" / "parts"
VMC = (ROOT / "simulator" / "data" / "machines" / "vmc15.toml").read_text(encoding="utf-8")
CORPUS = ROOT.parent / "shared" / "corpus" / "iso14649"
CORPUS_FILES = sorted(CORPUS.iterdir()) if CORPUS.is_dir() else []


@pytest.fixture
def bracket(tmp_path: Path) -> Path:
    return copy_of("bracket.stpnc", tmp_path)


@pytest.fixture
def paper(tmp_path: Path) -> Path:
    return copy_of("paper002.stpnc", tmp_path)


def copy_of(name: str, folder: Path) -> Path:
    path = folder / name
    path.write_bytes((PARTS / name).read_bytes())
    return path


def weak_machine(folder: Path, *, force: float) -> str:
    """A machining centre that bears but a small cutting force."""
    path = folder / "weak.toml"
    text = VMC.replace("max_cutting_force_n = 8_000", f"max_cutting_force_n = {force:g}")
    path.write_text(text, encoding="utf-8")
    return str(path)


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_the_result_lies_beside_the_program_and_the_program_stays(paper: Path) -> None:
    before = paper.read_bytes()
    told: list[str] = []
    outcome = advising.advise_program(*asked_advice(file=paper), tell=told.append)
    assert outcome.written == paper.with_name("paper002.optimised.stpnc")
    assert paper.read_bytes() == before
    assert names(paper.parent) == ["paper002.optimised.stpnc", "paper002.stpnc"]
    assert told[-1] == f"written: {outcome.written}"


def test_the_result_can_be_checked_and_optimised_again(paper: Path) -> None:
    first = advising.advise_program(*asked_advice(file=paper, machine="paper002"))
    assert first.written is not None
    assert check(first.written).is_usable
    again = advising.advise_program(
        *asked_advice(file=first.written, machine="paper002", dry_run=True)
    )
    one, other = first.plan.advices[0].after, again.plan.advices[0].after
    assert one is not None
    assert other is not None
    assert other.feed == pytest.approx(one.feed, rel=1e-6)


def test_in_place_overwrites_the_program_only(paper: Path) -> None:
    before = paper.read_bytes()
    outcome = advising.advise_program(*asked_advice(file=paper, in_place=True))
    assert outcome.written == paper
    assert paper.read_bytes() != before
    assert names(paper.parent) == ["paper002.stpnc"]


def test_a_named_output_may_replace_an_older_result(paper: Path) -> None:
    output = paper.with_name("result.stpnc")
    output.write_bytes(b"older")
    advising.advise_program(*asked_advice(file=paper, output=output))
    assert output.read_bytes().startswith(b"ISO-10303-21;")


def test_a_dry_run_writes_nothing(paper: Path) -> None:
    before = paper.read_bytes()
    for request in (
        asked_advice(file=paper, dry_run=True),
        asked_advice(file=paper, dry_run=True, in_place=True),
        asked_advice(file=paper, dry_run=True, output=paper.with_name("missing") / "x"),
    ):
        outcome = advising.advise_program(*request)
        assert outcome.written is None
        assert outcome.plan.advices
    assert paper.read_bytes() == before
    assert names(paper.parent) == ["paper002.stpnc"]


def test_same_program_same_result(bracket: Path) -> None:
    one, other = bracket.with_name("one"), bracket.with_name("other")
    advising.advise_program(*asked_advice(file=bracket, output=one))
    advising.advise_program(*asked_advice(file=bracket, output=other))
    assert one.read_bytes() == other.read_bytes()


@pytest.mark.parametrize("name", ["ROUGH POCKET", "#16"])
def test_only_the_workingstep_that_is_named_is_advised(bracket: Path, name: str) -> None:
    outcome = advising.advise_program(*asked_advice(file=bracket, workingsteps=(name,)))
    assert [advice.workingstep.id for advice in outcome.plan.advices] == ["ROUGH POCKET"]


def test_an_unknown_workingstep_lists_all_that_are_known(bracket: Path) -> None:
    with pytest.raises(StepNcError) as caught:
        advising.advise_program(
            *asked_advice(file=bracket, workingsteps=("ROUGH POCKET", "nope"))
        )
    message = str(caught.value)
    assert message.startswith("no workingstep 'nope'; known: ")
    assert "'ROUGH FACE' (#10)" in message
    assert "'REAM HOLE 2' (#25)" in message


def test_limits_that_conflict_are_told_with_their_numbers(bracket: Path) -> None:
    """Under 139 N a drill makes no chip that its edges bite into."""
    machine = weak_machine(bracket.parent, force=139.0)
    asked = asked_advice(file=bracket, machine=machine, workingsteps=("DRILL HOLE 1",))
    plan = advising.advise_program(*asked).plan
    assert plan.is_infeasible
    drilled = next(each for each in plan.advices if each.workingstep.id == "DRILL HOLE 1")
    assert drilled.status is AdviceStatus.INFEASIBLE
    for words in ("cutting force", "139 N", "feed per tooth against rubbing", "0.0588 mm"):
        assert words in drilled.reason


def test_a_chisel_edge_that_takes_more_than_the_bound_allows_no_feed(bracket: Path) -> None:
    machine = weak_machine(bracket.parent, force=30.0)
    asked = asked_advice(file=bracket, machine=machine, workingsteps=("DRILL HOLE 1",))
    (drilled,) = advising.advise_program(*asked).plan.advices
    assert drilled.status is AdviceStatus.INFEASIBLE
    for words in ("cutting force", "exceeds 30 N", "however small the feed"):
        assert words in drilled.reason


def test_an_infeasible_workingstep_stays_as_it_is_and_the_others_are_written(
    bracket: Path,
) -> None:
    machine = weak_machine(bracket.parent, force=900.0)
    some = ("DRILL HOLE 1", "DRILL HOLE 2", "CENTRE HOLE 1", "FINISH CONTOUR")
    outcome = advising.advise_program(
        *asked_advice(file=bracket, machine=machine, workingsteps=some)
    )
    assert outcome.written is not None
    before = bracket.read_text(encoding="ascii").splitlines()
    after = set(outcome.written.read_text(encoding="ascii").splitlines())
    drilling = [line for line in before if line.startswith(("#212=", "#213=", "#311="))]
    assert len(drilling) == 3
    assert after.issuperset(drilling)
    advised = [each for each in outcome.plan.advices if each.status is AdviceStatus.ADVISED]
    assert advised
    changed = read_program(outcome.written, units="iso")
    original = read_program(bracket, units="iso")
    pairs = zip(original.workingsteps, changed.workingsteps, strict=True)
    statuses = {each.workingstep.id: each.status for each in outcome.plan.advices}
    for old, new in pairs:
        if statuses.get(old.id) is AdviceStatus.INFEASIBLE:
            assert new.technology_ref == old.technology_ref


def test_nothing_is_written_when_no_workingstep_is_feasible(bracket: Path) -> None:
    """At 1 mm/min no edge of the milled part takes a chip."""
    machine = bracket.with_name("slow.toml")
    text = VMC.replace("max_feed_mm_min = 20_000", "max_feed_mm_min = 1")
    machine.write_text(text, encoding="utf-8")
    told: list[str] = []
    request = asked_advice(file=bracket, machine=str(machine))
    outcome = advising.advise_program(*request, tell=told.append)
    assert outcome.plan.is_infeasible
    assert outcome.written is None
    assert "nothing was written: no workingstep was advised" in told
    assert told[-1].startswith("infeasible, left as programmed: 'ROUGH FACE'")
    assert names(bracket.parent) == ["bracket.stpnc", "slow.toml"]


def test_names_that_nobody_knows_have_errors_of_their_own(paper: Path) -> None:
    with pytest.raises(UnknownMachine) as machine:
        advising.advise_program(*asked_advice(file=paper, machine="vmc51"))
    assert machine.value.known[0] == "vmc15"
    with pytest.raises(UnknownMaterial) as material:
        advising.advise_program(*asked_advice(file=paper, material="unobtanium"))
    assert "titanium2" in material.value.near


def test_a_turned_part_gets_a_lathe_and_a_milled_one_a_mill() -> None:
    for name, machine in (("shaft.stpnc", "lathe22"), ("bracket.stpnc", "vmc15")):
        plan = advising.advise_program(*asked_advice(file=PARTS / name, dry_run=True)).plan
        assert plan.machine.name == machine


@pytest.mark.parametrize("profile", FileProfile)
def test_records_convert_there_and_back(paper: Path, profile: FileProfile) -> None:
    written = advising.advise_program(*asked_advice(paper, profile=profile)).written
    assert written is not None
    (other,) = set(FileProfile) - {profile}
    there, back = paper.with_name("there"), paper.with_name("back")
    stepnc.convert(written, profile=other.value, output=there)
    stepnc.convert(there, profile=profile.value, output=back)
    assert check(there).is_usable
    assert check(back).is_usable


def keywords(path: Path) -> Counter[str]:
    file = Part21File.from_bytes(path.read_bytes())
    return Counter(file.keyword(number) for number in file.ids())


@pytest.mark.parametrize("name", ["paper002.stpnc", "shaft.stpnc"])
def test_a_strict_reader_takes_the_program_as_optimise_writes_it(
    name: str, tmp_path: Path
) -> None:
    # What NIST's parser takes: entities of the standard, in their own number of parameters.
    before, after = copy_of(name, tmp_path), tmp_path / "after"
    assert stepnc.optimise(before, output=after).is_advised
    added = keywords(after) - keywords(before)
    assert added["NUMERIC_PARAMETER"] > 0
    technologies = {"MILLING_TECHNOLOGY", "TURNING_TECHNOLOGY"}
    assert set(added) <= {"NUMERIC_PARAMETER", "DESCRIPTIVE_PARAMETER"} | technologies
    assert schemas_of(before) == schemas_of(after)
    program = Program.load(after)
    assert [step.operation.its_optimisation for step in program.workingsteps] == [
        None for _ in program.workingsteps
    ]


def test_a_program_with_a_record_in_entities_keeps_that_form(paper: Path) -> None:
    once, twice = paper.with_name("once"), paper.with_name("twice")
    stepnc.optimise(paper, output=once, profile="optimisation")
    stepnc.optimise(once, output=twice)
    assert once.read_bytes() == twice.read_bytes()
    assert keywords(twice)["TIME_CRITICAL_OPTIMISATION"] > 0


def schemas_of(path: Path) -> bytes:
    return next(line for line in path.read_bytes().split(b"\n") if b"FILE_SCHEMA" in line)


def test_a_program_is_not_converted_onto_itself(paper: Path) -> None:
    before = paper.read_bytes()
    with pytest.raises(WriteError, match="name another file"):
        stepnc.convert(paper, profile="standard", output=paper)
    assert paper.read_bytes() == before


def test_check_tells_what_is_wrong_rather_than_raise(paper: Path) -> None:
    text = paper.read_text(encoding="ascii").replace(
        "#1=PROJECT('PAPER 002',#2", "#1=PROJECT('',$"
    )
    paper.write_text(text, encoding="ascii")
    contents = check(paper)
    assert not contents.is_usable
    assert contents.program is None
    assert contents.findings[-1].severity is Severity.ERROR
    assert "no main workplan" in contents.findings[-1].message


@pytest.mark.parametrize("path", CORPUS_FILES, ids=lambda path: path.name)
def test_a_public_program_is_optimised_or_refused_with_its_place(path: Path) -> None:
    answer = answer_to(asked_advice(file=path, dry_run=True))
    if isinstance(answer, SchemaError):
        assert answer.line > 0
        assert answer.entity
    elif isinstance(answer, StepNcError):
        assert str(answer)
    else:
        assert answer.plan.advices


def answer_to(request: AskedAdvice) -> ProgramAdvice | StepNcError:
    """What comes of a request: an error of the project is an answer too."""
    try:
        return advising.advise_program(*request)
    except StepNcError as error:
        return error


def test_the_public_programs_are_here() -> None:
    if not CORPUS_FILES:
        pytest.skip("../shared/corpus is not here")
    assert len(CORPUS_FILES) > 5
