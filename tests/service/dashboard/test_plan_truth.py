"""Truth in colours on Plan: what is open, slower or exceeded is never green."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Page, Route, expect

from tests.service.dashboard.conftest import keep
from tests.service.dashboard.test_plan import optimised

Change = Callable[[dict[str, Any]], object]


def shown_with(page: Page, change: Change) -> None:
    """Show the plan of paper002 anew, with one thing in its result changed."""

    def answer(route: Route) -> None:
        reply = route.fetch()
        result = reply.json()
        change(result)
        route.fulfill(response=reply, json=result)

    advice = page.url.split("advice=")[-1].split("&")[0]
    page.route(f"**/v1/advice/{advice}", answer)
    page.reload()
    expect(page.locator("#time-saved")).to_be_visible()


def unchecked(result: dict[str, Any]) -> None:
    result["workingsteps"][0]["unchecked"] = [{"name": "roughness", "reason": "none is known"}]


def slower(result: dict[str, Any]) -> None:
    result["total_time_s"]["after"] = 2.0 * result["total_time_s"]["before"]


def exceeded(result: dict[str, Any]) -> None:
    result["confirmation"] = {"passed": ["force 2 N over 1 N"], "workingsteps": []}


def test_a_plan_that_saves_time_and_leaves_nothing_open_is_green(page: Page) -> None:
    optimised(page, "paper002")
    shown_with(
        page, lambda result: [each.update(unchecked=[]) for each in result["workingsteps"]]
    )
    expect(page.locator("#time-saved.good")).to_be_visible()


@pytest.mark.parametrize("change", [unchecked, slower, exceeded])
def test_what_is_open_slower_or_exceeded_is_not_green(page: Page, change: Change) -> None:
    optimised(page, "paper002")
    shown_with(page, change)
    assert "good" not in (page.locator("#time-saved").get_attribute("class") or "").split()


def untouched(result: dict[str, Any]) -> None:
    step = result["workingsteps"][0]
    step.update(status="untouched", advised=None)
    step["limits"][0]["margin"] = -0.5


def test_an_exceeded_limit_of_a_step_that_the_plan_leaves_alone_is_not_red(page: Page) -> None:
    optimised(page, "paper002")
    shown_with(page, untouched)
    page.locator("#steps tr.step .opener").first.click()
    expect(page.locator("tr.detail")).to_contain_text("not of this plan")
    expect(page.locator("tr.detail .bad, tr.detail .over")).to_have_count(0)


def test_nc_code_for_any_control_needs_no_new_run(page: Page, tmp_path: Path) -> None:
    optimised(page, "paper002")
    advised = page.locator("#steps tr.step").first.inner_text()
    assert advised
    for control, start in (("haas", "%"), ("heidenhain", "BEGIN PGM")):
        page.locator("#download-control").select_option(control)
        with page.expect_download() as code:
            page.locator("#download-nc").click()
        code.value.save_as(tmp_path / control)
        assert start in (tmp_path / control).read_text(encoding="utf-8")[:200]
    page.reload()
    expect(page.locator("#download-control")).to_have_value("heidenhain")
    keep(page, "plan-nc")
