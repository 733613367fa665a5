"""A second run of ``optimise`` on its own file changes nothing: no feed, and no byte."""

from pathlib import Path
from typing import Any

import pytest

from optimiser.modes import Mode
from service.requests.advice import AdviceRequest
from service.verbs.optimise.program import advise_program as optimise
from service.verbs.optimise.request import AdviceFiles

ROOT = Path(__file__).parents[2]
PARTS = ROOT / "examples" / "parts"
CORPUS = ROOT.parent / "shared" / "corpus" / "iso14649"

CASES: list[tuple[Path, dict[str, Any]]] = [
    *((file, {}) for file in sorted(PARTS.glob("*.stpnc"))),
    (PARTS / "bracket.stpnc", {"given": ("#205.axial_cutting_depth=1.4",)}),
    (CORPUS / "RanhuraPerfilVee.p21", {"units": "rpm-mmtooth"}),
    (CORPUS / "RanhuraPerfilVee.p21", {"units": "rpm-mmtooth", "mode": Mode.EC}),
    (
        CORPUS / "Ranhura.p21",
        {
            "units": "rpm-mmtooth",
            "feed": "0.1mm/tooth",
            "given": ("#36.spindle=-960.",),
        },
    ),
    (CORPUS / "EXAMPLE1_original.stp", {"feed": "240"}),
    (CORPUS / "EXAMPLE3.stp", {}),
    (CORPUS / "ex1.stp", {}),
    (CORPUS / "ex1E.stp", {}),
    (CORPUS / "furo.p21", {"units": "revs-mmtooth"}),
]
"""Programs, and what is given beyond them."""


@pytest.mark.parametrize(("file", "given"), CASES, ids=lambda each: getattr(each, "stem", ""))
def test_nothing_moves(file: Path, given: dict[str, Any], tmp_path: Path) -> None:
    """Both runs are given the same, as a user would who repeats a command."""
    if not file.exists():
        pytest.skip(f"{file.name} does not lie beside the project")
    material = "" if file.stem.startswith("paper") else "c45"
    request = AdviceRequest(material=material, **given)
    first, second = tmp_path / "first.stpnc", tmp_path / "second.stpnc"
    one = optimise(request, AdviceFiles(file=file, output=first))
    assert one.written is not None
    two = optimise(request, AdviceFiles(file=first, output=second))
    assert [settings(each.after) for each in two.plan.advices] == [
        settings(each.after) for each in one.plan.advices
    ]
    assert second.read_bytes() == first.read_bytes()


def settings(state: Any) -> tuple[Any, ...]:
    """Feed, depth, passes, speed and plunge feed, to what a file holds of them."""
    if state is None:
        return ()
    at = state.setting
    values = (at.feed, at.depth, at.passes, at.speed, at.plunge_feed)
    return tuple(None if value is None else float(f"{value:.9g}") for value in values)
