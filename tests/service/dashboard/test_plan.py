"""Plan: from a file to feeds with reasons, and back to a file."""

import csv
import json
import re
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from stepnc_model.programs.program import Program
from tests.service.dashboard.conftest import keep
from tests.service.waiting import ROOT

BRACKET = ROOT / "examples" / "parts" / "bracket.stpnc"


def optimised(page: Page, sample: str) -> None:
    """An advice for a sample, as a user asks for it."""
    page.goto("/dashboard/plan.html")
    page.locator("#program-example").select_option(sample)
    expect(page.locator("#program-shown")).to_contain_text(f"{sample}.stpnc")
    page.locator("#machine").select_option("vmc15")
    page.locator("#optimise").click()
    expect(page.locator("#steps tr.step").first).to_be_visible(timeout=120_000)


def test_a_file_is_uploaded_optimised_and_downloaded(page: Page, tmp_path: Path) -> None:
    page.goto("/dashboard/plan.html")
    expect(page.locator("#optimise")).to_be_disabled()
    page.locator("#program-file").set_input_files(BRACKET)
    expect(page.locator("#program-shown")).to_contain_text("bracket.stpnc")
    page.locator("#machine").select_option("vmc15")
    page.locator("#nc-control").select_option("linuxcnc")
    page.locator("#optimise").click()
    rows = page.locator("#steps tr.step")
    expect(rows.first).to_be_visible(timeout=120_000)
    assert rows.count() == 16
    expect(page.locator("#steps")).to_contain_text("feed per tooth 0.35 mm reaches its bound")
    contour = page.locator("#steps tr.step", has_text="ROUGH CONTOUR")
    expect(contour).to_contain_text("10 × 2→20 × 1")
    with page.expect_download() as cells:
        page.locator("#download-csv").click()
    cells.value.save_as(tmp_path / "table.csv")
    with (tmp_path / "table.csv").open(encoding="utf-8", newline="") as file:
        lines = {line["workingstep"]: line for line in csv.DictReader(file)}
    found = lines["ROUGH CONTOUR"]
    assert (found["passes_programmed"], found["passes_advised"]) == ("2", "1")
    with page.expect_download() as download:
        page.locator("#download-program").click()
    assert download.value.suggested_filename == "bracket.optimised.stpnc"
    download.value.save_as(tmp_path / "part.stpnc")
    program = Program.load(tmp_path / "part.stpnc")
    assert len(program.workingsteps) == 16
    with page.expect_download() as code:
        page.locator("#download-nc").click()
    code.value.save_as(tmp_path / "part.ngc")
    assert "G1" in (tmp_path / "part.ngc").read_text(encoding="utf-8")
    with page.expect_download() as table:
        page.locator("#download-json").click()
    table.value.save_as(tmp_path / "plan.json")
    plan = json.loads((tmp_path / "plan.json").read_text(encoding="utf-8"))
    assert plan["total_time_s"]["after"] < plan["total_time_s"]["before"]
    expect(page.locator("#path-card")).to_be_visible(timeout=120_000)
    for view, drawn in (("2d", "#path-flat-plot canvas"), ("3d", "#path-plot")):
        page.locator(f"#path-view [data-value='{view}']").click()
        for colour in page.locator("#path-colour option").all():
            page.locator("#path-colour").select_option(colour.get_attribute("value"))
        expect(page.locator(drawn)).to_be_visible()
    keep(page, "plan")


def test_a_workingstep_opens_by_keyboard_and_headings_sort(page: Page) -> None:
    optimised(page, "paper002")
    opener = page.locator("#steps tr.step .opener").first
    opener.focus()
    page.keyboard.press("Enter")
    detail = page.locator("#detail-0")
    expect(detail).to_contain_text("feed per tooth0.054 ≤ 0.054 mm")
    page.locator("#sort-feed").focus()
    page.keyboard.press("Enter")
    expect(page.locator("#steps th[aria-sort]").first).to_be_visible()


def test_a_plan_stands_beside_its_run(page: Page) -> None:
    page.goto("/dashboard/plan.html")
    page.locator("#program-example").select_option("shaft")
    expect(page.locator("#program-shown")).to_contain_text("shaft.stpnc")
    page.locator("#more-options summary").click()
    page.locator("#confirm").check()
    page.locator("#optimise").click()
    figures = page.locator("#confirmed-figures")
    expect(figures.locator("tbody tr")).to_have_count(5)
    expect(figures).to_contain_text("FINISH CONTOUR")
    expect(figures).to_contain_text("1.000")
    expect(page.locator("#confirmed-passed")).to_be_empty()
    again = page.url
    page.goto("/dashboard/plan.html")
    page.goto(again)
    expect(page.locator("#confirmed")).to_be_visible(timeout=120_000)
    expect(page.locator("#confirm")).to_be_checked()


def test_a_plan_that_was_not_run_shows_no_run(page: Page) -> None:
    optimised(page, "paper002")
    expect(page.locator("#confirmed")).to_be_hidden()


@pytest.mark.parametrize("text", ["no program at all", "ISO-10303-21;"])
def test_a_bad_file_is_refused_in_words(page: Page, text: str, tmp_path: Path) -> None:
    bad = tmp_path / "bad.stpnc"
    bad.write_text(text, encoding="utf-8")
    page.goto("/dashboard/plan.html")
    page.locator("#program-file").set_input_files(bad)
    expect(page.locator("#program-problem [role=alert]")).to_contain_text("line 1")
    expect(page.locator("#optimise")).to_be_disabled()


def test_an_advice_can_be_opened_again(page: Page) -> None:
    optimised(page, "paper002")
    expect(page).to_have_url(re.compile("advice="))
    page.reload()
    expect(page.locator("#steps tr.step").first).to_be_visible()


def test_an_example_is_kept_once(page: Page) -> None:
    found = []
    for _ in range(2):
        page.goto("/dashboard/plan.html")
        page.locator("#program-example").select_option("paper002")
        expect(page.locator("#program-known")).not_to_have_value("")
        found.append(page.locator("#program-known").input_value())
    assert found[0] == found[1]
