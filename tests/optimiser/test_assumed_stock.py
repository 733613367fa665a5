"""Given tool paths without a raw part get their engagement from what they remove in turn."""

from pathlib import Path

import pytest

from optimiser.bounds.tolerance import left_by_path
from optimiser.cuts.fixtured_stock import assumed_stock, words_of
from optimiser.cuts.path_cuts import MeasuredCuts
from simulator.library import load_machine, load_material
from stepnc_model.programs.program import Program

CORPUS = Path(__file__).parents[3] / "shared" / "corpus" / "iso14649"
PARTS = Path(__file__).parents[2] / "examples" / "parts"
GIVEN = CORPUS / "ex1E.stp"

given = pytest.mark.skipif(not GIVEN.exists(), reason="ex1E.stp is not beside the project")


@pytest.fixture(scope="module")
def program() -> Program:
    return Program.load(GIVEN)


@given
class TestNistExample:
    """NIST's part is 100 mm × 120 mm with 5 mm on its face, which the file does not say."""

    def test_the_stock_reaches_from_the_deepest_path_to_the_highest_feature(
        self, program: Program
    ) -> None:
        stock = assumed_stock(program, program.workingsteps[0].setup)
        assert stock is not None
        assert stock.low[2] == pytest.approx(-37.1378, abs=1e-3)
        assert stock.high[2] == pytest.approx(5.0)
        assert "no stock is known: assumed is the box" in words_of(stock)

    def test_no_path_comes_down_into_it(self, program: Program) -> None:
        """The face is entered at (91.9, -13.5) with 18 mm, beside the part."""
        stock = assumed_stock(program, program.workingsteps[0].setup)
        assert stock is not None
        assert stock.low[1] == pytest.approx(-13.5 + 9.0)

    def test_the_face_is_cut_as_deep_as_its_path_goes(self, program: Program) -> None:
        """Two levels of 2.5 mm, not the 5 mm of the feature."""
        cuts = MeasuredCuts(program, load_machine("vmc15"), load_material("c45"))
        cut, findings = cuts.cut(program.workingsteps[0])
        assert cut.hardest is not None
        depth = cut.hardest.depth_share * cut.programmed.depth
        assert depth == pytest.approx(2.5, abs=0.05)
        texts = [finding.message for finding in findings]
        assert not any("full depth and width assumed" in text for text in texts)
        assert any("assumed is the box" in text for text in texts)

    def test_roughing_leaves_what_finishing_goes_further_out(self, program: Program) -> None:
        by_id = {step.id: step for step in program.workingsteps}
        assert left_by_path(program, by_id["WS ROUGH POCKET1 A"]) == pytest.approx(1.0, abs=0.1)
        assert left_by_path(program, by_id["WS FINISH POCKET1 P"]) == 0.0


def test_generated_paths_have_no_assumed_stock() -> None:
    program = Program.load(PARTS / "paper002.stpnc")
    assert assumed_stock(program, program.workingsteps[0].setup) is None
