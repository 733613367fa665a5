"""Jobs: what runs, and how one ends it."""

from playwright.sync_api import Page, expect

from tests.service.dashboard.conftest import keep


def test_a_job_is_seen_cancelled_and_deleted(page: Page) -> None:
    program = page.request.post("/v1/programs?example=paper002").json()["id"]
    asked = {"program_id": program, "pace": 1.0}
    job = page.request.post("/v1/simulations", data=asked).json()["id"]
    page.goto("/dashboard/jobs.html")
    row = page.locator(f"#job-{job}")
    expect(row).to_have_attribute("data-state", "running")
    keep(page, "jobs")
    row.locator("[data-act='cancel']").click()
    expect(row).to_have_attribute("data-state", "cancelled")
    row.locator("[data-act='delete']").click()
    page.locator("#confirm-yes").click()
    expect(row).to_have_count(0)
    assert page.request.get(f"/v1/jobs/{job}").status == 404
