"""The page holds what the table says, and fetches nothing."""

import re
from pathlib import Path

import pytest

from service.verbs.optimise.program import advise_program as optimise
from tests.asking import asked_advice

PARTS = Path(__file__).parents[2] / "examples" / "parts"


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> str:
    folder = tmp_path_factory.mktemp("report")
    source = folder / "a&b <i>.stpnc"
    source.write_bytes((PARTS / "bracket.stpnc").read_bytes())
    return optimise(*asked_advice(file=source, pareto=True)).page()


def own(page: str) -> str:
    """The page without the plotting library."""
    return re.sub(r"<script>.*?</script>", "", page, count=1, flags=re.DOTALL)


def test_every_workingstep_has_a_row_with_its_reason(page: str) -> None:
    assert page.count("<tr><td>") == 16
    assert "353.7 → 1237.9" in page
    assert "untouched: inhibit_feedrate_override: the program locks this feed" in page


def test_all_five_plots_are_drawn(page: str) -> None:
    for title in (
        "Time by workingstep",
        "Feed",
        "Motor power before and after",
        "Share of each limit that the advice uses",
        "Pareto fronts of time and roughness",
    ):
        assert title in own(page)


def test_names_from_the_file_cannot_become_markup(page: str) -> None:
    assert "a&amp;b &lt;i&gt;.stpnc" in page
    assert "<i>" not in own(page)


def test_nothing_is_loaded_from_elsewhere(page: str) -> None:
    assert not re.search(r"<(?:script|link|img|iframe)[^>]*\s(?:src|href)=", own(page))


def test_the_total_change_has_its_sign(page: str) -> None:
    assert re.search(r"change<b>−\d+%</b>", page)
