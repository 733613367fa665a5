"""Knowledge: tables of what was planned and what it was; a correction is accepted."""

import csv
from pathlib import Path

from playwright.sync_api import Page, expect

from tests.service.dashboard.conftest import keep


def test_a_table_is_made_and_exported(page: Page, tmp_path: Path) -> None:
    page.goto("/dashboard/knowledge.html")
    rows = page.locator("#evaluation tbody tr")
    expect(rows.first).to_be_visible(timeout=120_000)
    with page.expect_download() as download:
        page.locator("#get-csv").click()
    download.value.save_as(tmp_path / "table.csv")
    with (tmp_path / "table.csv").open(encoding="utf-8", newline="") as file:
        lines = list(csv.DictReader(file))
    assert lines
    assert {"machine", "feature", "kc_factor", "grade"} <= set(lines[0])


def test_a_correction_is_reviewed_and_accepted(page: Page) -> None:
    page.goto("/dashboard/knowledge.html")
    page.locator("#review").click()
    accept = page.locator("#factor-table [data-act='accept']")
    expect(accept.first).to_be_visible(timeout=120_000)
    accept.first.click()
    expect(page.locator("#confirm")).to_contain_text("k_c")
    page.locator("#decide-by").fill("A. Smith")
    page.locator("#confirm-yes").click()
    expect(page.locator("#factor-table")).to_contain_text("in force")
    found = page.request.get("/v1/corrections").json()["corrections"]
    assert "A. Smith" in {each["accepted_by"] for each in found}
    keep(page, "knowledge")
