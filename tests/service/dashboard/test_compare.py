"""The compare page: plans chosen, told apart, and opened."""

from playwright.sync_api import Page, expect

from tests.service.dashboard.conftest import keep
from tests.service.waiting import until


def test_plans_are_chosen_and_told_apart(page: Page) -> None:
    program = page.request.post("/v1/programs?example=paper002").json()["id"]
    asked = {"machine": "vmc15", "material": "c45"}
    jobs = [
        page.request.post(f"/v1/programs/{program}/advice", data={**asked, **more}).json()["id"]
        for more in ({"mode": "TC"}, {"mode": "EC", "free": ["feed", "depth", "speed"]})
    ]
    until(lambda: all(is_over(page, job) for job in jobs))
    page.goto(f"/dashboard/plan.html?advice={jobs[0]}")
    page.locator("#compare-link").click()
    expect(page.locator("#compare-totals tbody tr")).to_have_count(2)
    expect(page.locator("#compare-differences li")).to_have_count(1)
    expect(page.locator("#compare-differences")).to_contain_text("ROUGH THE FACE")
    expect(page.locator("#compare-steps tbody tr")).to_have_count(2)
    expect(page.locator("#compare-trade .main-svg").first).to_be_visible()
    keep(page, "compare")
    page.locator("#compare-plans input").first.uncheck()
    expect(page.locator("#compared")).to_contain_text("Choose 2 to 12 plans")


def is_over(page: Page, job: str) -> bool:
    """True if an advice has its result."""
    return bool(page.request.get(f"/v1/jobs/{job}").json()["state"] == "succeeded")
