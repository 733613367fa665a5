"""Feeds along the paths in the STEP-NC file: what is read back runs as planned."""

import re
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

import stepnc
from service.along_path.course import PathSource
from service.along_path.run import FeedsAlongPath, along_path
from service.along_path.task import task_of
from service.cli.main import optimise_main
from service.errors import BAD_INPUT
from service.files import sibling
from service.programs.reading import read_program
from service.progress import silent
from service.requests.advice import AdviceRequest
from service.requests.runs import SimulationRequest
from service.simulation.run import RunFiles, simulate
from service.simulation.setup import PreparedRun, prepared_program
from service.verbs.optimise.plan_result import ProgramAdvice
from service.verbs.optimise.program import advise_program as optimise
from service.verbs.optimise.request import AdviceFiles
from simulator.motion.model_name import ControlModelName
from stepnc_model.editing.file_profile import FileProfile
from stepnc_model.errors import StepNcError
from stepnc_model.post.dialect import Dialect
from stepnc_model.toolpath.explicit.factor_curve import RAMP
from tests.service.along_path.samples import PARTS, SHAFT

FACE, POCKET = PARTS / "paper002.stpnc", PARTS / "paper003_pocket.stpnc"
SAMPLES = [
    (FACE, FileProfile.OPTIMISATION),
    (FACE, FileProfile.STANDARD),
    (SHAFT, FileProfile.OPTIMISATION),
    (POCKET, FileProfile.STANDARD),
]
IDS = ["face", "face, standard", "shaft", "pocket, standard"]
WITHIN = 1.01


def request_of(profile: FileProfile) -> AdviceRequest:
    return AdviceRequest(is_along_path=True, writes_toolpaths=True, safety=0.5, profile=profile)


@cache
def planned(sample: Path, profile: FileProfile, folder: Path) -> ProgramAdvice:
    """Optimise a sample, and write its feeds along the paths."""
    output = folder / f"{profile.value}_{sample.name}"
    request = replace(request_of(profile), nc_control=Dialect.LINUXCNC)
    return optimise(request, AdviceFiles(file=sample, output=output))


@cache
def run_again(sample: Path, profile: FileProfile, folder: Path) -> FeedsAlongPath:
    """Run the written file at its own feeds."""
    result = planned(sample, profile, folder)
    plan, program = result.plan, read_program(written(result), units="iso")

    def prepare(margin: float) -> PreparedRun:
        return prepared_program(
            program, plan.machine, plan.material, tell=silent, margin=margin
        )

    task = replace(task_of(request_of(profile), plan.machine), margin=0.0)
    return along_path(PathSource(prepare=prepare, bounds=lambda _: None), task)


def written(result: ProgramAdvice) -> Path:
    assert result.written is not None
    return result.written


def along_of(result: ProgramAdvice) -> FeedsAlongPath:
    assert result.along is not None
    return result.along


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder for the files of the samples."""
    return tmp_path_factory.mktemp("paths")


@pytest.mark.parametrize(("sample", "profile"), SAMPLES, ids=IDS)
def test_the_file_takes_the_planned_time(
    sample: Path, profile: FileProfile, folder: Path
) -> None:
    along = along_of(planned(sample, profile, folder))
    again = run_again(sample, profile, folder)
    assert along.time_after < along.time_before
    assert again.time_before == pytest.approx(along.time_after, rel=2e-3)
    for step, other in zip(along.steps, again.steps, strict=True):
        assert other.before.duration == pytest.approx(step.after.duration, rel=0.01), step.name


@pytest.mark.parametrize(("sample", "profile"), SAMPLES, ids=IDS)
def test_loads_of_the_file_keep_their_bounds(
    sample: Path, profile: FileProfile, folder: Path
) -> None:
    plan = planned(sample, profile, folder).plan
    bounds = {
        advice.workingstep.id: {
            load.limit.name.value: load.bound for load in (advice.after or advice.before).loads
        }
        for advice in plan.advices
        if advice.before is not None
    }
    efficiency = plan.machine.spindle.efficiency
    for step in run_again(sample, profile, folder).steps:
        known, load = bounds.get(step.name, {}), step.before
        if "tool_deflection" in known:
            assert load.deflection.value <= WITHIN * known["tool_deflection"], step.name
        if "motor_power" in known:
            assert load.cutting_power.value <= WITHIN * efficiency * known["motor_power"]
        if "cutting_force" in known:
            assert max(load.force.value, load.thrust.value) <= WITHIN * known["cutting_force"]


def words_of(line: str) -> dict[str, float]:
    """Addresses of a block of NC code with their numbers."""
    code = re.sub(r"\(.*?\)", "", line)
    return {word: float(number) for word, number in re.findall(r"([A-Z])(-?[\d.]+)", code)}


@pytest.mark.parametrize(("sample", "profile"), [SAMPLES[0], SAMPLES[2]], ids=["face", "shaft"])
def test_nc_code_of_the_file_has_the_planned_feeds(
    sample: Path, profile: FileProfile, folder: Path, tmp_path: Path
) -> None:
    """Blocks are split at the same places, but for ramps of a hundredth of a millimetre."""
    result = planned(sample, profile, folder)
    code = sibling(written(result), Dialect.LINUXCNC.suffix)
    again = tmp_path / "again.ngc"
    stepnc.post(written(result), control="linuxcnc", output=again)
    lines, others = code.read_text().splitlines(), again.read_text().splitlines()
    assert len(lines) == len(others)
    feeds = 0
    for line, other in zip(lines, others, strict=True):
        expected, found = words_of(line), words_of(other)
        assert found.keys() == expected.keys(), line
        assert found.get("F") == expected.get("F"), line
        feeds += "F" in found
        for axis in found.keys() & {"X", "Y", "Z"}:
            assert found[axis] == pytest.approx(expected[axis], abs=2.0 * RAMP + 1e-3), line
    assert feeds > 3


def test_the_file_can_be_optimised_again(folder: Path, tmp_path: Path) -> None:
    """A second plan replaces the tool paths of the first."""
    first = written(planned(FACE, FileProfile.OPTIMISATION, folder))
    again = optimise(
        request_of(FileProfile.OPTIMISATION),
        AdviceFiles(file=first, output=tmp_path / "again.stpnc"),
    )
    lists = [written(again), first]
    assert [path.read_bytes().count(b"=TOOLPATH_LIST(") for path in lists] == [1, 1]
    assert along_of(again).time_after == pytest.approx(
        along_of(planned(FACE, FileProfile.OPTIMISATION, folder)).time_after, rel=0.02
    )


def test_simulate_takes_the_planned_time(folder: Path) -> None:
    result = planned(FACE, FileProfile.OPTIMISATION, folder)
    request = SimulationRequest(machine=result.plan.machine.name, control=ControlModelName.FIR)
    found = simulate(request, RunFiles(file=written(result)))
    assert found.whole.duration == pytest.approx(along_of(result).time_after, rel=0.01)


@pytest.mark.parametrize("profile", FileProfile)
def test_only_the_operation_differs_from_a_file_with_one_feed(
    profile: FileProfile, folder: Path, tmp_path: Path
) -> None:
    request = replace(request_of(profile), writes_toolpaths=False)
    one = written(optimise(request, AdviceFiles(file=FACE, output=tmp_path / "one.stpnc")))
    before, after = (
        path.read_bytes().splitlines()
        for path in (one, written(planned(FACE, profile, folder)))
    )
    assert [row[:24] for row in before if row not in after] == [b"#40=PLANE_ROUGH_MILLING("]
    added = [row for row in after if row not in before]
    assert after[after.index(added[1]) :] == [*added[1:], *before[-2:]]


def test_the_option_needs_feeds_along_the_path(tmp_path: Path) -> None:
    request = AdviceRequest(writes_toolpaths=True)
    with pytest.raises(StepNcError, match="--write-toolpaths needs --along-path"):
        optimise(request, AdviceFiles(file=FACE, output=tmp_path / "out.stpnc"))


def test_nc_code_has_no_place_for_tool_paths(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    code = tmp_path / "part.ngc"
    code.write_text("G21 G90\nM2\n")
    with pytest.raises(SystemExit) as stopped:
        optimise_main([str(code), "--along-path", "--write-toolpaths"])
    assert stopped.value.code == BAD_INPUT
    assert "tool paths are written into STEP-NC programs" in capsys.readouterr().err
