"""A review on a terminal."""

from pathlib import Path

from kbe.acceptance import AcceptanceBounds
from service.knowledge.review import Acceptance, review
from service.knowledge.verbs import record
from service.requests.knowledge import ReviewRequest
from service.verbs.kbe.review.result import ReviewReport
from stepnc_model.outcome import ProcessOutcome
from tests.kbe.cuts import SLOT

MINE = ReviewRequest(machine="vmc15", material="C45", tool="ENDMILL 18")


def test_a_proposal_tells_what_it_rests_on_and_what_speaks_against_it(
    kb: str, shop_outcomes: tuple[ProcessOutcome, ...]
) -> None:
    used = [each for each in shop_outcomes if each.context.tool == MINE.tool
            and each.context.machine == MINE.machine
            and each.context.material == MINE.material]  # fmt: skip
    acceptance = Acceptance(bounds=AcceptanceBounds(fewest_outcomes=999))
    out = str(ReviewReport(contexts=review(kb, MINE, acceptance)))
    assert out.startswith("1  vmc15 / C45 / ENDMILL 18: proposed\n")
    runs = len({each.run for each in used})
    assert f"from {len(used)} outcomes of {runs} runs" in out
    assert "90 % interval" in out
    assert "in force before: the catalogue's k_c" in out
    assert "needs a person's decision: learned from" in out


def test_what_was_left_out_is_told(tmp_path: Path) -> None:
    place = str(tmp_path / "kb.db")
    record(place, [SLOT])
    out = str(ReviewReport(contexts=review(place, ReviewRequest())))
    assert out.startswith("–  vmc15 / C45 / MILL 18: nothing to learn from\n")
    assert "left out: 1 no force ratio" in out
