"""Machine: a run of the virtual machine, while it runs and afterwards."""

import re
from pathlib import Path

import pyarrow.parquet as pq
from playwright.sync_api import Page, expect

from tests.service.dashboard.conftest import keep


def start(page: Page, *, pace: str) -> None:
    """A run of the sample of paper 002."""
    program = page.request.post("/v1/programs?example=paper002").json()["id"]
    page.goto(f"/dashboard/machine.html?program={program}")
    expect(page.locator("#start")).to_be_visible()
    page.locator("#start-machine").select_option("vmc15")
    page.locator("#start-pace").select_option(pace)
    page.locator("#start-run").click()


def test_a_run_is_watched_and_its_samples_are_downloaded(page: Page, tmp_path: Path) -> None:
    start(page, pace="10")
    expect(page.locator("#now-execution")).to_contain_text("ACTIVE")
    expect(page.locator("#now-feed-actual")).to_contain_text(re.compile(r"[1-9]"))
    expect(page.locator("#now-workingstep")).to_contain_text("ROUGH THE FACE")
    expect(page.locator("#run-message")).to_have_text("")
    expect(page.locator("#run-line progress")).to_have_count(0)
    expect(page.locator("#totals")).to_be_visible(timeout=120_000)
    expect(page.locator("#now-execution")).to_contain_text("PROGRAM COMPLETED")
    expect(page.locator("#now-spindle")).to_have_text("0")
    at_end = "(slider) => slider.value === slider.max && Number(slider.max) > 100"
    assert page.locator("#at-time").evaluate(at_end)
    energy = page.locator("#totals .figure", has_text="Energy").locator(".value").inner_text()
    expect(page.locator("#now-energy")).to_have_text(energy)
    # 168 s of the machine: all of them, and no more.
    page.wait_for_function("document.querySelector('#run-chart').layout.xaxis.range[1] < 200")
    with page.expect_download() as download:
        page.locator("#get-samples").click()
    download.value.save_as(tmp_path / "run.parquet")
    table = pq.read_table(tmp_path / "run.parquet")
    assert {"time_s", "x_axis_wattage", "c_axis_wattage"} <= set(table.column_names)
    assert table.num_rows > 1000
    keep(page, "machine")


def test_a_recorded_run_shows_how_it_was_at_a_time(page: Page) -> None:
    start(page, pace="0")
    expect(page.locator("#totals")).to_be_visible(timeout=120_000)
    page.reload()
    expect(page.locator("#totals")).to_be_visible()
    expect(
        page.locator("#run-chart .js-plotly-plot, #run-chart.js-plotly-plot")
    ).to_be_visible()


def test_a_cancelled_run_shows_how_it_was_when_it_was_ended(page: Page) -> None:
    start(page, pace="10")
    expect(page.locator("#now-execution")).to_contain_text("ACTIVE")
    page.locator("#run-cancel").click()
    expect(page.locator("#at-words")).to_contain_text("State when the run was cancelled")
    expect(page.locator("#now-execution")).to_have_text("CANCELLED")
