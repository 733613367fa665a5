"""axe-core on every page: nothing serious, light and dark, on a wide screen and on a phone."""

from importlib.resources import files
from importlib.util import find_spec

import pytest
from playwright.sync_api import Page, expect

from tests.service.dashboard.conftest import PHONE, WIDE
from tests.service.dashboard.test_control import running
from tests.service.dashboard.test_plan import optimised

PACKAGE = "axe_playwright_python"
"""Carries axe.min.js; nothing is fetched."""

PAGES = ["plan", "compare", "control", "machine", "factory", "verify", "knowledge", "jobs"]

pytestmark = pytest.mark.skipif(
    find_spec(PACKAGE) is None, reason=f"{PACKAGE} is not installed: pip install -e .[dev]"
)


def serious(page: Page) -> list[str]:
    """Serious and critical findings, with the elements they are at."""
    page.evaluate((files(PACKAGE) / "axe.min.js").read_text(encoding="utf-8"))
    found = page.evaluate("axe.run(document, { resultTypes: ['violations'] })")
    return [
        f"{each['id']}: {node['target']} {node['failureSummary']}"
        for each in found["violations"]
        if each["impact"] in {"serious", "critical"}
        for node in each["nodes"]
    ]


def checked(page: Page) -> list[str]:
    """Serious findings in light and dark, on a wide screen and on a phone."""
    found = serious(page)
    page.get_by_role("button", name="switch between light and dark").click()
    found += serious(page)
    page.set_viewport_size(PHONE)
    found += serious(page)
    page.set_viewport_size(WIDE)
    page.get_by_role("button", name="switch between light and dark").click()
    return found


@pytest.mark.parametrize("name", PAGES)
def test_an_empty_page_has_no_serious_finding(page: Page, name: str) -> None:
    page.goto(f"/dashboard/{name}.html")
    page.wait_for_load_state("networkidle")
    assert checked(page) == []


def test_a_plan_has_no_serious_finding(page: Page) -> None:
    optimised(page, "paper002")
    page.locator("#steps tr.step .opener").first.click()
    expect(page.locator("tr.detail")).to_be_visible()
    assert checked(page) == []


def test_a_run_and_its_dialogs_have_no_serious_finding(page: Page) -> None:
    run = running(page, pace=1.0)
    page.locator("#hold").click()
    expect(page.locator("#run-state")).to_have_text("Held")
    found = checked(page)
    page.locator("#end").click()
    found += serious(page)
    page.locator("#end-question-no").click()
    page.locator("#keys").click()
    found += serious(page)
    page.request.post(f"/v1/control-runs/{run}/cancel")
    assert found == []
