"""Samples of LinuxCNC's package: a second run on the output of ``optimise`` changes no byte."""

from pathlib import Path

import pytest

from benchmarks.nc_samples import Sample, sample_of
from service.along_path.rewritten_code import composed
from service.verbs.optimise.code_result import CodeAdvice
from stepnc_model.nc.written_lines import WrittenLines
from stepnc_model.post.block_feeds import BlockPart
from tests.stepnc_model.nc.conftest import SAMPLES
from tests.stepnc_model.post.conftest import interpreter_in

NAMES = [
    "b-index.ngc",
    "cds.ngc",
    "comp-g1.ngc",
    "comp.ngc",
    "comp311.ngc",
    "gmoccapy_2_tools_with_cutter_radius_compensation.ngc",
    "lathe_pawn.ngc",
    "polar.ngc",
    "spiral.ngc",
    "tool-length-probe.ngc",
]
"""Samples that take a second or so; ``benchmarks/nc_samples.py`` takes all."""

PLANNED = 1.01
"""Greatest time of a run over that of its plan."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of LinuxCNC's samples."""
    interpreter_in(tmp_path_factory.mktemp("rs274"))
    if not SAMPLES.is_dir():
        pytest.skip("the package of LinuxCNC holds no samples")
    return SAMPLES


def runs(sample: Sample | None, place: Path) -> tuple[CodeAdvice, CodeAdvice]:
    """Advice for a sample, and for its output."""
    assert sample is not None
    first = sample.advised(sample.data, place)
    return first, sample.advised(first.rewritten.data, place)


@pytest.mark.parametrize("name", NAMES)
def test_a_second_run_changes_no_byte(name: str, folder: Path, tmp_path: Path) -> None:
    first, second = runs(sample_of(folder / name), tmp_path)
    assert first.rewritten.changed > 0
    assert second.rewritten.data == first.rewritten.data
    assert second.along.time_before == pytest.approx(first.along.time_after)
    assert 1.0 / PLANNED < first.along.time_after / first.along.planned_time < PLANNED


def test_a_plan_that_its_own_run_would_change_is_planned_again(
    folder: Path, tmp_path: Path
) -> None:
    """With three feeds, split blocks of this sample tell more of the engagement."""
    sample = sample_of(folder / "cds.ngc", diameter=12.0, levels=3)
    first, second = runs(sample, tmp_path)
    assert second.rewritten.data == first.rewritten.data


def part(end: float, rate: float) -> BlockPart:
    return BlockPart(end=end, rate=rate)


def test_feeds_of_pieces_replace_those_of_their_part_of_the_block() -> None:
    lines = WrittenLines()
    lines.divide(3, [1.0, 3.0])
    feeds = {3: (part(0.25, 5.0), part(1.0, 7.0)), 9: (part(1.0, 2.0),)}
    more = {4: (part(0.5, 6.0), part(1.0, 8.0)), 6: (part(1.0, 4.0),)}
    assert composed(feeds, more, lines) == {
        3: (part(0.25, 5.0), part(0.625, 6.0), part(1.0, 8.0)),
        5: (part(1.0, 4.0),),
        9: (part(1.0, 2.0),),
    }
