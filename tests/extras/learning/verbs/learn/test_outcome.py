"""A learned factor on k_c reaches a plan by the knowledge base, and by no other way."""

from math import exp
from pathlib import Path

import pytest

from extras.learning.models import ForceFactor
from extras.learning.verbs.learn.run import write_outcome
from service.knowledge.outcome_import import add_outcomes
from service.knowledge.review import review
from service.knowledge.verbs import accept, accepted_factors
from service.requests.knowledge import ReviewRequest
from stepnc_model.errors import StepNcError
from tests.every_case import every_case

PARTS = Path(__file__).parents[5] / "examples" / "parts"
PART = PARTS / "paper003_pocket.stpnc"
FOUND = ForceFactor(factor=1.15, factor_error=0.004, offset=60.0, offset_error=4.0, runs=100)
NAMES = {"part": ("one",), "machine": ("paper003",), "material": ("aisi1018",)}


def test_a_plan_gets_the_factor_once_it_is_accepted(tmp_path: Path) -> None:
    file, place = tmp_path / "kc.json", str(tmp_path / "shop.db")
    write_outcome(file, FOUND, program=PART, names=NAMES)
    assert add_outcomes(place, file).new == 1
    (found,) = review(place, ReviewRequest())
    assert found.entry is not None
    tool = {"machine": "paper003", "material": "aisi1018", "tools": ["END MILL 8MM"]}
    assert accepted_factors(place, **tool) == ()  # type: ignore[arg-type]
    accept(place, [found.entry.id], by="somebody")
    (factor,) = accepted_factors(place, **tool)  # type: ignore[arg-type]
    assert factor.centre == pytest.approx(1.15, rel=0.02), "drawn a little to the prior's 1"
    assert 1.0 < factor.centre < factor.factor
    correction = factor.correction
    assert exp(correction.log_centre) == pytest.approx(factor.centre)


@every_case(
    ("factor", "names", "part", "message"),
    [
        (1.15, NAMES | {"machine": ("a", "b")}, "paper003_pocket", "one machine, but .* a, b"),
        (1.15, NAMES, "bracket", "one tool, but the program mills with .*FACE MILL"),
        (7.0, NAMES, "paper003_pocket", "factor 7 on k_c: it must be 0.2 to 5"),
    ],
)
def test_a_factor_that_belongs_to_nothing_is_refused(
    tmp_path: Path, factor: float, names: dict[str, tuple[str, ...]], part: str, message: str
) -> None:
    found = ForceFactor(factor=factor, factor_error=0.1, offset=0.0, offset_error=1.0, runs=30)
    file = tmp_path / "kc.json"
    with pytest.raises(StepNcError, match=message):
        write_outcome(file, found, program=PARTS / f"{part}.stpnc", names=names)
    assert not file.exists()
