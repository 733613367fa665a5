"""Verify: a log, a run or a machine against a program, and where the part is wrong."""

import csv
import json
import re
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.extras.agent.test_run import run_of
from tests.extras.brep.shapes import block, write_step
from tests.extras.verification.files import write_log
from tests.extras.verification.logs import SLOT_MACHINE, slot_log
from tests.extras.verification.runs import fast_log, program
from tests.extras.verification.test_step_parts import pocketed
from tests.extras.verification.test_without_program import (
    BLOCK,
    OFFSET,
    POCKET,
    pocket_inputs,
)
from tests.service.dashboard.conftest import inside, keep, opened_page
from tests.service.monitor.played import PlayedAgent
from tests.service.rest.samples import SLOT
from tests.service.rest.server import Server, made, over
from tests.service.waiting import until

PAGE = "/dashboard/verify.html"
LATE = 60_000
"""ms"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Watched:
    """A service that monitors a machine, with a program and a finished run of it."""

    server: Server
    slot: str
    run: str


@pytest.fixture(scope="module")
def watched(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Watched]:
    folder = tmp_path_factory.mktemp("verified")
    played = run_of("paper003_case1", SLOT_MACHINE, rate_hz=5.0, speed=0.0)
    with (
        PlayedAgent(*played) as agent,
        Server(folder, "--agent", f"{SLOT_MACHINE}={agent.url}") as server,
    ):
        with server.client() as client:
            path = "/v1/programs?name=slot.stpnc"
            slot = made(client.post(path, content=SLOT.read_bytes()), 201)
            asked = {"program_id": slot, "machine": SLOT_MACHINE, "rate_hz": 5.0}
            run = made(client.post("/v1/simulations", json=asked))
            assert over(client, run)["state"] == "succeeded"
        yield Watched(server=server, slot=slot, run=run)
        assert server.faults() == ""


@pytest.fixture
def page(
    browser_thread: ThreadPoolExecutor, browser: Browser, watched: Watched
) -> Iterator[Page]:
    with inside(browser_thread, opened_page(browser, watched.server)) as page:
        yield page


def wrong_log(folder: Path) -> Path:
    """Positions of the bracket, with the pocket moved and the slot too deep."""
    log = fast_log()
    position = log.position.copy()
    position[log.within(program(), "FINISH POCKET"), 0] += 0.15
    position[log.within(program(), "MILL SLOT"), 2] -= 0.08
    return replace(log, position=position).write(folder / "log.parquet", program())


def chosen(page: Page, watched: Watched) -> None:
    """The program of the slot, and coarse cells."""
    page.locator("#program-known").select_option(watched.slot)
    expect(page.locator("#program-shown")).to_contain_text("slot.stpnc")
    page.locator("#machine").select_option(SLOT_MACHINE)
    page.locator("#more-options summary").click()
    page.locator("#cell").fill("0.5")


def drawn(page: Page) -> int:
    """Number of places that exceed their uncertainty, as the plan says to who cannot see it."""
    label = page.locator("#map-plan canvas").get_attribute("aria-label") or ""
    found = re.search(r"(\d+) of \d+ places exceed", label)
    return int(found[1]) if found else -1


def made_by(page: Page, path: str, *, data: object) -> str:
    """Id of what a request of the page has made."""
    answer = page.request.post(path, data=data)
    assert answer.ok, answer.text()
    return str(answer.json()["id"])


def marked(page: Page) -> str:
    """Picture of the plan, as text."""
    found: str = page.locator("#map-plan canvas").evaluate("(plan) => plan.toDataURL()")
    return found


def test_an_error_is_shown_at_its_place(page: Page, tmp_path: Path) -> None:
    page.goto(PAGE)
    expect(page.locator("#verify")).to_be_disabled()
    expect(page.locator("#verify-hint")).to_have_text("Choose positions first.")
    page.locator("#log-file").set_input_files(wrong_log(tmp_path))
    expect(page.locator("#log-name")).to_have_text("log.parquet")
    expect(page.locator("#verify-hint")).to_have_text("Choose a program first.")
    page.locator("#program-example").select_option("bracket")
    expect(page.locator("#program-shown")).to_contain_text("bracket.stpnc")
    page.locator("#machine").select_option("vmc15")
    page.locator("#verify").click()
    expect(page.locator("#lamp")).to_have_text("ERROR", timeout=LATE)
    verdict = page.locator("#verdict-text")
    expect(verdict).to_contain_text("Gouge of 0.1500 ± 0.0010 mm")
    expect(verdict).to_contain_text("wall of FINISH POCKET")
    expect(verdict).to_contain_text("2 surfaces are beyond ± 0.0254 mm")
    # The log is too coarse for corners, which the page must say.
    expect(page.locator("#blind")).to_contain_text("at square corners")
    expect(page.locator("#not-seen")).to_contain_text("backlash")
    wrong = page.locator("#surfaces tr.wrong")
    expect(wrong).to_have_count(2)
    expect(wrong.first).to_contain_text("MILL SLOT")
    expect(wrong.first).to_contain_text("0.0800")
    assert drawn(page) > 50
    before = marked(page)
    wrong.nth(1).locator(".opener").focus()
    page.keyboard.press("Enter")
    expect(wrong.nth(1)).to_have_attribute("aria-selected", "true")
    detail = page.locator("#surface-detail")
    expect(detail).to_contain_text("FINISH POCKET, wall")
    expect(detail).to_contain_text("cut by FINISH POCKET")
    assert marked(page) != before
    keep(page, "verify")
    for value in ("all", "beyond"):
        page.locator("#map-show").select_option(value)
    page.locator("#map-scale").select_option("greatest")
    page.locator("#map-step").select_option(label="FINISH CONTOUR")
    wrong.first.click()
    expect(page.locator("#map-step")).to_have_value("")
    solid = page.locator("#map-view [data-value='solid']")
    solid.click()
    expect(page.locator("#map-solid")).to_have_attribute("aria-label", re.compile("3D"))
    expect(page.locator("#map-plan")).to_be_hidden()


def test_the_result_is_downloaded(page: Page, watched: Watched, tmp_path: Path) -> None:
    log = slot_log(tmp_path / "deep.parquet", lower=0.1).read_bytes()
    file = made_by(page, "/v1/files?name=deep.parquet", data=log)
    asked = {"program_id": watched.slot, "machine": SLOT_MACHINE, "cell_mm": 0.5}
    id = made_by(page, "/v1/verifications", data={**asked, "log_id": file})
    page.goto(f"{PAGE}?id={id}")
    expect(page.locator("#lamp")).to_have_text("ERROR", timeout=LATE)
    expect(page.locator("#log-known")).to_have_value(file)
    with page.expect_download() as cells:
        page.locator("#download-csv").click()
    cells.value.save_as(tmp_path / "places.csv")
    with (tmp_path / "places.csv").open(encoding="utf-8", newline="") as places:
        rows = list(csv.DictReader(places))
    worst = min(float(row["deviation_mm"]) for row in rows)
    assert worst == pytest.approx(-0.1, abs=0.001)
    with page.expect_download() as download:
        page.locator("#download-json").click()
    download.value.save_as(tmp_path / "found.json")
    found = json.loads((tmp_path / "found.json").read_text(encoding="utf-8"))
    assert found == page.request.get(f"/v1/verifications/{id}").json()
    with page.context.expect_page() as report:
        page.locator("#open-report").click()
    expect(report.value.locator("h1")).to_have_text("deep.parquet")
    point = report.value.locator("#plan .scatterlayer .point").first
    expect(point).to_be_visible(timeout=LATE)


def test_a_run_brings_its_program_and_is_opened_again(page: Page, watched: Watched) -> None:
    page.goto(f"/dashboard/machine.html?id={watched.run}")
    page.locator("#verify-run").click()
    expect(page.locator("#program-of-run")).to_be_visible()
    expect(page.locator("#drop")).to_be_hidden()
    page.locator("#verify").click()
    expect(page.locator("#lamp")).to_have_text("NO ERROR SEEN", timeout=LATE)
    expect(page.locator("#verdict-text")).to_contain_text("Nothing exceeds the uncertainty")
    # At 5 Hz corners are not resolved; a tolerance of 1 mm is.
    expect(page.locator("#blind")).to_contain_text("at square corners")
    assert drawn(page) == 0
    expect(page).to_have_url(re.compile("id="))
    page.reload()
    expect(page.locator("#lamp")).to_have_text("NO ERROR SEEN", timeout=LATE)
    expect(page.locator("#run-known")).to_have_value(watched.run)
    page.locator("#tolerance").fill("1")
    page.locator("#verify").click()
    expect(page.locator("#lamp")).to_have_text("WITHIN TOLERANCE", timeout=LATE)
    expect(page.locator("#blind")).to_have_count(0)


def test_a_monitored_machine_is_verified(page: Page, watched: Watched) -> None:
    path = f"/v1/monitors/{SLOT_MACHINE}"
    until(lambda: page.request.get(path).json()["execution"] == "PROGRAM_COMPLETED")
    page.goto(PAGE)
    page.locator("#log-from [data-value='monitor']").click()
    page.locator("#monitor-known").select_option(SLOT_MACHINE)
    chosen(page, watched)
    page.locator("#verify").click()
    expect(page.locator("#lamp")).to_have_text("NO ERROR SEEN", timeout=LATE)
    expect(page.locator("#result-of")).to_contain_text(f"latest run of {SLOT_MACHINE}")
    with page.expect_download() as log:
        page.locator("#download-log").click()
    assert log.value.suggested_filename.endswith(".parquet")


def test_the_cycle_time_stands_beside_the_logged_one(page: Page, watched: Watched) -> None:
    page.goto(f"{PAGE}?run={watched.run}")
    page.locator("#cycle").click()
    rows = page.locator("#cycle-rows")
    expect(rows).to_contain_text("MILL SLOT", timeout=LATE)
    expect(rows.locator("tfoot")).to_contain_text(re.compile(r"\b0\.\d\d %"))
    page.locator("#cycle-more summary").click()
    expect(page.locator("#cycle-stretches")).to_contain_text("acceleration and corners")
    page.reload()
    expect(rows).to_contain_text("MILL SLOT", timeout=LATE)


def test_a_file_that_is_no_log_is_refused_in_words(page: Page, tmp_path: Path) -> None:
    page.goto(PAGE)
    bad = tmp_path / "log.csv"
    bad.write_text("a,b\n1,2\n", encoding="utf-8")
    page.locator("#log-file").set_input_files(bad)
    expect(page.locator("#log-problem [role=alert]")).to_have_text("log.csv: no column time_s")
    expect(page.locator("#verify")).to_be_disabled()
    page.locator("#more-options summary").click()
    page.locator("#tools-file").set_input_files(bad)
    expect(page.locator("#tools-place [role=alert]")).to_contain_text(
        "none of the known formats"
    )


def test_one_solid_of_a_step_file_takes_the_place_of_a_program(
    page: Page, tmp_path: Path
) -> None:
    lid = block((0.0, 0.0, 5.0), (40.0, 30.0, 9.0))
    tools = pocket_inputs(tmp_path).tools
    assert tools is not None
    page.goto(PAGE)
    page.locator("#log-file").set_input_files(write_log(tmp_path / "log.csv", POCKET + OFFSET))
    page.locator("#machine").select_option("vmc15")
    page.locator("#more-options summary").click()
    page.locator("#cell").fill("0.2")
    page.locator("#stock").fill(BLOCK)
    page.locator("#tools-file").set_input_files(tools)
    expect(page.locator("#tools-place")).to_contain_text("tools.toml")
    part = write_step(tmp_path / "part.step", lid, pocketed())
    page.locator("#required-file").set_input_files(part)
    expect(page.locator("#required-place")).to_contain_text("part.step", timeout=LATE)
    page.locator("#verify").click()
    alert = page.locator("#verify-problem [role=alert]")
    expect(alert).to_contain_text("part.step: 2 solids: choose one", timeout=LATE)
    page.locator("#required-solid").fill("2")
    page.locator("#verify").click()
    expect(page.locator("#lamp")).to_have_text("ERROR", timeout=LATE)
    keep(page, "verify-solid")


def test_a_log_of_another_program_is_told_and_another_try_is_possible(
    page: Page, watched: Watched, tmp_path: Path
) -> None:
    page.goto(PAGE)
    log = slot_log(tmp_path / "other.parquet", change="elsewhere")
    page.locator("#log-file").set_input_files(log)
    expect(page.locator("#log-name")).to_have_text("other.parquet")
    chosen(page, watched)
    page.locator("#verify").click()
    alert = page.locator("#verify-problem [role=alert]")
    expect(alert).to_contain_text("is it a run of this program", timeout=LATE)
    expect(page.locator("#result")).to_be_hidden()
    expect(page.locator("#verify")).to_be_enabled()
    page.locator("#zero-how").select_option("given")
    page.locator("#zero").fill("500,0,0")
    page.locator("#verify").click()
    expect(page.locator("#lamp")).to_have_text("NO ERROR SEEN", timeout=LATE)
    expect(page.locator("#verify-problem")).to_be_empty()


def test_a_part_that_is_only_faced_gets_a_sentence(page: Page) -> None:
    program = page.request.post("/v1/programs?example=paper002").json()["id"]
    wanted = {"program_id": program, "rate_hz": 20.0}
    run = page.request.post("/v1/simulations", data=wanted).json()["id"]
    until(lambda: page.request.get(f"/v1/jobs/{run}").json()["state"] == "succeeded")
    page.goto(f"{PAGE}?run={run}")
    page.locator("#verify").click()
    problem = page.locator("#verify-problem")
    expect(problem).to_contain_text("as when a part is only faced", timeout=LATE)
    keep(page, "verify-faced")
