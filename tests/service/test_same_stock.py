"""Numbers of passes that leave other stock are no candidates: a pocket whose walls slope."""

from pathlib import Path

import pytest

from optimiser.advice import Advice
from service.cli.main import optimise_main
from service.verbs.optimise import program as advising
from tests.asking import asked_advice

PARTS = Path(__file__).parents[2] / "examples" / "parts"
VEE = PARTS.parents[2] / "shared" / "corpus" / "iso14649" / "RanhuraPerfilVee.p21"


def advised(file: Path, *, units: str = "iso", free: str = "feed,depth") -> list[Advice]:
    asked = asked_advice(file=file, machine="vmc15", units=units, free=free, dry_run=True)
    return list(advising.advise_program(*asked).plan.advices)


@pytest.fixture(scope="module")
def sloped() -> list[Advice]:
    if not VEE.exists():
        pytest.skip("the corpus is not beside the project")
    return advised(VEE, units="rpm-mmtooth")


def test_sloped_flanks_keep_the_number_of_passes(sloped: list[Advice]) -> None:
    """Two passes would leave 5.57 mm and 4.6 cm³ more than the programmed seven."""
    rough = sloped[0]
    assert rough.cut is not None
    assert rough.after is not None
    assert rough.after.setting.passes == 7
    refused = {each.passes: each.why for each in rough.cut.refused_passes}
    assert "5.57 mm more" in refused[2]


def test_what_is_left_to_the_finish_is_what_the_program_leaves(sloped: list[Advice]) -> None:
    volumes = [each.cut.volume for each in sloped if each.cut is not None]
    as_given = advised(VEE, units="rpm-mmtooth", free="feed")
    assert volumes == [each.cut.volume for each in as_given if each.cut is not None]


def test_upright_walls_have_their_passes_chosen() -> None:
    asked = asked_advice(
        file=PARTS / "bracket.stpnc",
        machine="vmc15",
        workingsteps=("ROUGH POCKET",),
        dry_run=True,
    )
    (rough,) = advising.advise_program(*asked).plan.advices
    assert rough.cut is not None
    assert rough.after is not None
    assert rough.after.setting.passes < rough.cut.programmed.passes
    assert rough.cut.refused_passes == ()


def test_a_set_depth_that_does_not_divide_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    """11.8 mm in passes of 3.9333 mm are four, by a hair."""
    with pytest.raises(SystemExit):
        optimise_main([
            str(PARTS / "bracket.stpnc"),
            *("--machine", "vmc15", "--workingstep", "ROUGH POCKET", "--dry-run"),
            *("--set", "#206.axial_cutting_depth=3.9333"),
        ])
    told = "".join(capsys.readouterr())
    assert "4 passes of 2.95 mm; 3 passes need at least 3.9334 mm" in told
