"""Factory: a shop on its floor, live, with a failure, and its figures."""

import csv
import re
from pathlib import Path

from playwright.sync_api import Page, expect

from extras.factory.figures import COLOURS
from tests.service.dashboard.conftest import SCREENSHOTS, keep
from tests.service.waiting import ROOT

SHOP = """
title = "Saw, mills and washer"
hours = 60

[[machine]]
name = "saw"
idle_power_w = 250
[machine.handling]
batch_setup_s = 120
batch_setup_w = 350

[[machine]]
name = "mill"
count = 3
idle_power_w = 900
[machine.handling]
batch_setup_s = 600
batch_setup_w = 1100
part_setup_s = { kind = "uniform", low = 30, high = 60 }
part_setup_w = 950

[[machine]]
name = "washer"
idle_power_w = 400

[[buffer]]
name = "blanks"
capacity = 4

[[buffer]]
name = "to wash"
capacity = 3

[[product]]
name = "plate"
batch = 5
[[product.step]]
machines = ["saw"]
time_s = 90
power_w = 1800
into = "blanks"
[[product.step]]
machines = ["mill"]
time_s = { kind = "uniform", low = 300, high = 420 }
power_w = 5200
into = "to wash"
scrap = 0.02
[[product.step]]
machines = ["washer"]
time_s = 100
power_w = 3000
"""


def test_colours_of_states_are_those_of_the_report() -> None:
    text = (ROOT / "service" / "dashboard" / "factory_states.js").read_text()
    found = dict(re.findall(r'^  "([a-z -]+)": "(#[0-9a-fA-F]{6})",$', text, re.MULTILINE))
    assert {name: tone.lower() for name, tone in found.items()} == {
        state.value: tone.lower() for state, tone in COLOURS.items()
    }


def test_a_live_shop_fails_is_repaired_and_ends_with_its_figures(
    page: Page, tmp_path: Path
) -> None:
    page.goto("/dashboard/factory.html")
    page.locator("#start-box").evaluate("(box) => { box.open = true; }")
    page.locator("#shop-choice").select_option("own")
    page.locator("#shop-text").fill(SHOP)
    page.locator("#shop-pace").select_option("1000")
    page.locator("#shop-run").click()
    mill = page.locator('[data-machine="mill-2"]')
    expect(mill.locator(".state-name")).to_have_text("machining")
    expect(page.locator("#figure-good .value")).to_have_text(re.compile(r"[1-9]"))
    expect(page.locator('[data-buffer="blanks"]')).to_contain_text("of 4 batches")
    page.locator("#pace").select_option("300")
    expect(page.locator("#strip")).to_be_visible()
    mill.locator("[data-fail]").click()
    page.locator("#repair").fill("60")
    page.locator("#confirm-yes").click()
    expect(mill.locator(".state-name")).to_have_text("repair")
    expect(mill.locator("[data-fail]")).to_be_disabled()
    expect(page.locator('#log [data-kind="failed"]')).to_contain_text("mill-2 failed")
    expect(page.locator("#live-processes")).to_contain_text("plate step 2 on mill-1")
    keep(page, "factory")
    expect(page.locator('#log [data-kind="repaired"]')).to_contain_text("mill-2 is repaired")
    # The page that is loaded anew shows the run as it goes on.
    page.reload()
    expect(mill.locator(".state-name")).to_have_text(re.compile(r"\w"))
    expect(page.locator('#log [data-kind="failed"]')).to_contain_text("mill-2 failed")
    page.locator("#end").click()
    page.locator("#confirm-yes").click()
    row = page.locator("#result-states tbody tr", has_text="mill-2")
    expect(row).to_be_visible(timeout=120_000)
    heads = page.locator("#result-states thead th").all_inner_texts()
    assert row.locator("th, td").all_inner_texts()[heads.index("repair")] == "1"
    with page.expect_download() as download:
        page.locator("#get-figures").click()
    download.value.save_as(tmp_path / "figures.csv")
    with (tmp_path / "figures.csv").open(encoding="utf-8") as file:
        rows = [each for each in csv.DictReader(file) if each["figure"] == "down %"]
    down = {each["name"]: float(each["mean"]) for each in rows}
    assert down["mill-2"] > 0.0
    assert down["mill-1"] == down["saw"] == 0.0
    page.locator("#get-which").select_option("washer")
    with page.expect_download() as download:
        page.locator("#get-parts").click()
    assert download.value.suggested_filename == "washer.csv"
    keep(page, "factory-result")


def test_a_shop_is_run_with_replications(page: Page) -> None:
    page.goto("/dashboard/factory.html")
    page.locator("#start-box").evaluate("(box) => { box.open = true; }")
    page.locator("#shop-choice").select_option("own")
    page.locator("#shop-text").fill(SHOP)
    page.locator("#shop-pace").select_option("0")
    page.locator("#shop-replications").fill("4")
    page.locator("#shop-hours").fill("24")
    page.locator("#shop-run").click()
    expect(page.locator("#result-title")).to_contain_text("4 replications")
    expect(page.locator("#result-line")).to_contain_text("±")
    expect(page.locator("#floor")).to_be_hidden()


def test_a_bad_shop_file_is_refused_with_its_key(page: Page) -> None:
    page.goto("/dashboard/factory.html")
    page.locator("#start-box").evaluate("(box) => { box.open = true; }")
    page.locator("#shop-choice").select_option("own")
    page.locator("#shop-text").fill(SHOP.replace("capacity = 4", "capacity = -4"))
    page.locator("#shop-run").click()
    expect(page.locator("#start-problem")).to_contain_text("buffer[1].capacity")
    page.locator("#shop-text").fill("{")
    page.locator("#shop-run").click()
    expect(page.locator("#start-problem")).to_contain_text("not valid JSON")


def test_the_sample_line_runs_with_its_programs(page: Page) -> None:
    page.goto("/dashboard/factory.html")
    page.locator("#start-box").evaluate("(box) => { box.open = true; }")
    page.locator("#shop-choice").select_option("line")
    page.locator("#shop-pace").select_option("1000")
    page.locator("#shop-run").click()
    lathe = page.locator('[data-machine="lathe-1"]')
    expect(lathe).to_contain_text("shaft.stpnc")
    mill = page.locator('[data-machine="mill-1"]')
    expect(mill).to_contain_text("bracket.stpnc")
    page.locator("#window").select_option("")
    page.screenshot(path=SCREENSHOTS / "factory-line.png", full_page=True)
    page.locator("#end").click()
    page.locator("#confirm-yes").click()
    expect(page.locator("#result")).to_be_visible(timeout=120_000)
