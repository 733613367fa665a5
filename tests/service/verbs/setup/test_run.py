"""Drafts of setups: what stands in them, and that they come back."""

from pathlib import Path

import pytest

import stepnc
from service.simulation.setup_draft import Sureness
from service.simulation.setup_file import read_setup
from stepnc_model.errors import StepNcError

POSTS = Path(__file__).parents[3] / "data" / "posts"


@pytest.fixture
def part(tmp_path: Path) -> Path:
    """Program of a post, in a folder of its own."""
    place = tmp_path / "part.nc"
    place.write_bytes((POSTS / "fusion_inch.nc").read_bytes())
    return place


def test_a_draft_has_each_value_with_its_source(part: Path) -> None:
    draft = stepnc.setup(part)
    sure = {row.name: row.sure for row in draft.values}
    assert sure["material"] is sure["machine"] is Sureness.MISSING
    assert sure["stock"] is sure["T1 teeth"] is Sureness.GUESSED
    assert sure["T1 diameter_mm"] is sure["unit"] is Sureness.STATED
    assert all(row.source for row in draft.values)
    assert draft.missing == ("material (`stepnc materials`)",)


def test_a_draft_comes_back_as_it_was_found(part: Path) -> None:
    draft = stepnc.setup(part, material="c45", machine="vmc15")
    assert draft.written == part.with_name("part.setup.toml")
    read = read_setup(draft.written)
    assert (read.material, read.machine) == ("c45", "vmc15")
    assert read.is_stock_guessed
    assert [tool.number for tool in read.tools] == [1, 2, 3]
    assert read.guesses[2].has_teeth
    assert read.tools[1].shape.diameter == pytest.approx(6.35)  # type: ignore[union-attr]


@pytest.mark.parametrize("post", sorted(POSTS.iterdir()), ids=lambda post: post.name)
def test_every_post_has_a_draft_that_is_read(post: Path, tmp_path: Path) -> None:
    draft = stepnc.setup(post, output=tmp_path / "a.setup.toml")
    assert read_setup(tmp_path / "a.setup.toml").program == post.name
    assert draft.missing == ("material (`stepnc materials`)",)


def test_an_edited_setup_is_not_overwritten(part: Path) -> None:
    stepnc.setup(part)
    with pytest.raises(StepNcError, match="is there already"):
        stepnc.setup(part)
    stepnc.setup(part, dry_run=True)


def test_a_confirmed_guess_lets_feeds_rise_further(part: Path) -> None:
    draft = stepnc.setup(part, material="al6061", machine="vmc15")
    assert draft.written is not None
    guessed = stepnc.optimise(part, dry_run=True)
    lines = draft.written.read_text().splitlines()
    draft.written.write_text("\n".join(each for each in lines if "guessed = [" not in each))
    confirmed = stepnc.optimise(part, dry_run=True)
    assert guessed.along is not None
    assert confirmed.along is not None
    assert confirmed.along.time_after < guessed.along.time_after


def test_a_run_takes_the_same_setup(part: Path) -> None:
    stepnc.setup(part, material="c45", machine="vmc15")
    run = stepnc.simulate(part).simulation
    assert run.whole.volume > 0.0
    assert any("part.setup.toml" in each.message for each in run.findings)
    assert not run.collisions


def test_a_step_nc_program_needs_no_setup() -> None:
    part = Path(__file__).parents[4] / "examples" / "parts" / "paper002.stpnc"
    with pytest.raises(StepNcError, match="is no NC code"):
        stepnc.setup(part)


def test_a_unit_that_the_program_does_not_state_is_a_guess(tmp_path: Path) -> None:
    part = tmp_path / "bare.nc"
    part.write_text("(T1 D=10. - FLAT END MILL)\nG90\nT1 M6\nS50 M3\nG0 X0 Y0 Z5\nG1 Z-2 F9\n")
    (unit,) = (row for row in stepnc.setup(part, dry_run=True).values if row.name == "unit")
    assert (unit.value, unit.sure) == ("mm", Sureness.GUESSED)
