"""The page is whole, fetches nothing, and is the same for the same run."""

import re
from collections.abc import Callable
from dataclasses import replace
from html import unescape
from pathlib import Path

import pytest

from controller.orders import EventKind, LoopEvent
from service.control.run import ControlRun, control
from service.verbs.control.result import MOST_EVENTS, ControlResult
from stepnc_model.errors import Finding, Severity
from tests.asking import AskedControl

Controlled = Callable[..., AskedControl]


def own(run: ControlRun) -> str:
    """The page without the plotting library."""
    assert run.trace is not None
    page = ControlResult(run=run).page()
    return re.sub(r"<script>.*?</script>", "", page, count=1, flags=re.DOTALL)


def test_the_page_has_all_its_parts(control_run: ControlRun) -> None:
    text = own(control_run)
    for title in (
        "Limits exceeded", "The run", "Workingsteps", "What limited the override", "Events",
        "Disturbances", "Findings",
    ):  # fmt: skip
        assert f"<h2>{title}</h2>" in text
    assert "MILL SLOT: set point by " in text
    assert "under control" in text
    assert f"{control_run.time:.1f} s</b>" in text


def test_nothing_comes_from_or_goes_to_another_host(control_run: ControlRun) -> None:
    assert not re.search(r"https?:|//\w+\.|src=|href=", own(control_run))


def test_names_cannot_become_markup(control_run: ControlRun) -> None:
    finding = Finding(severity=Severity.WARNING, message="<i>spares</i>", line=1)
    event = LoopEvent(time=1.0, kind=EventKind.WEAR, text="tool '<i>T1</i>'")
    evil = replace(
        control_run,
        plan=replace(control_run.plan, program="<i>p</i>"),
        findings=(finding, finding),
        events=(event,),
    )
    text = own(evil)
    assert "<i>" not in text
    assert unescape(text).count("<i>spares</i>") == 1


def test_many_events_are_cut_with_a_word(control_run: ControlRun) -> None:
    events = tuple(
        LoopEvent(time=float(row), kind=EventKind.WARNING, text=f"number {row}.")
        for row in range(MOST_EVENTS + 5)
    )
    text = own(replace(control_run, events=events))
    assert f"{MOST_EVENTS + 5} warning" in text
    assert "5 more events are not listed" in text


def test_the_same_seed_makes_the_same_page(controlled: Controlled, tmp_path: Path) -> None:
    request, files = controlled(disturbances=("kc:1.2",), report=tmp_path / "run.html")
    one, again = own(control(request, files)), own(control(request, files))
    other = own(control(replace(request, seed=5), files))
    assert one == again
    assert other != one
    assert "seed 5" in other


@pytest.mark.parametrize("law", ["none", "mpc"])
def test_every_law_has_a_page(controlled: Controlled, tmp_path: Path, law: str) -> None:
    run = control(*controlled(law=law, has_preview=True, report=tmp_path / "run.html"))
    assert f"law {law}" in own(run)
