"""Control: the simulator of paper 002, Fig. 9, with the real loop: change it while it runs."""

import re
from typing import Any

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.service.dashboard.conftest import keep
from tests.service.rest.server import Server, over
from tests.service.waiting import until

DAY = re.compile(r"paper002\.stpnc, \d+ \w+ \d{4}, \d\d:\d\d:\d\d")


def begun(page: Page) -> None:
    """A trial cut that has reached its steady state."""
    page.goto("/dashboard/control.html?source=trial")
    page.locator("#start").click()
    expect(page.locator("#run-state")).to_have_text("Running")
    until(lambda: figure(page, "feed_actual_mm_min") > 1000.0)
    expect(page.locator("#lamp")).to_contain_text("SAFE")


def figure(page: Page, name: str) -> float:
    """A number of the output; 0 while there is none."""
    text = page.locator(f"#out-{name}").inner_text().replace(",", "")
    found = re.search(r"-?\d+(\.\d+)?", text)
    return float(found[0]) if found else 0.0


def set_input(page: Page, name: str, value: str) -> Locator:
    """A new value, as a user types it."""
    field = page.locator(f"#in-{name}")
    field.fill(value)
    field.press("Enter")
    return field


@pytest.fixture(autouse=True)
def ended(served: Server) -> None:
    """No trial of another test goes on."""
    with served.client() as client:
        for job in client.get("/v1/jobs?state=running&kind=trial").json()["items"]:
            client.post(f"/v1/trials/{job['id']}/cancel")
            over(client, job["id"])


def test_a_deeper_cut_raises_the_force_and_lowers_the_feed(page: Page) -> None:
    begun(page)
    force, feed = figure(page, "force"), figure(page, "feed_actual_mm_min")
    rate = figure(page, "removal_rate_cm3_min")
    set_input(page, "axial_depth_mm", "4")
    expect(page.locator("#lamp")).to_contain_text("OVER")
    expect(page.locator("#depth-warning")).to_contain_text("exceeds allowed 3 mm")
    expect(page.locator("#lamp")).to_contain_text("SAFE")
    until(lambda: figure(page, "feed_actual_mm_min") < 0.8 * feed)
    assert figure(page, "force") > 1.3 * force
    assert figure(page, "removal_rate_cm3_min") > rate
    expect(page.locator("#out-holding")).to_contain_text("motor power")
    expect(page.locator("#log")).to_contain_text("depth 2 -> 4 mm")
    keep(page, "control")


def test_tc_and_qc_on_and_off_are_switched_while_it_runs(page: Page) -> None:
    begun(page)
    # In a slot the width of cut is the tool's.
    expect(page.locator("#in-radial_width_mm")).to_have_value("50")
    page.locator("#switch-qc").click()
    expect(page.locator("#switch-qc")).to_have_attribute("aria-pressed", "true")
    expect(page.locator("#out-holding")).to_contain_text("QC")
    page.locator("#switch-tc").click()
    expect(page.locator("#switch-tc")).to_have_attribute("aria-pressed", "true")
    page.locator("#switch-off").click()
    expect(page.locator("#switch-off")).to_have_attribute("aria-pressed", "true")
    expect(page.locator("#out-feed_advised_mm_min")).to_have_text("–")
    set_input(page, "axial_depth_mm", "5")
    # Nobody holds the force: the drive stays over its limit.
    expect(page.locator("#lamp")).to_contain_text("OVER")
    page.locator("#switch-on").click()
    expect(page.locator("#lamp")).to_contain_text("SAFE")


def test_a_value_beyond_its_bounds_is_refused_at_its_field(page: Page) -> None:
    begun(page)
    field = set_input(page, "axial_depth_mm", "99")
    expect(page.locator("#in-axial_depth_mm-note")).to_contain_text("20")
    expect(field).to_have_value("2")


def test_a_reload_keeps_the_run_and_its_history(page: Page) -> None:
    begun(page)
    set_input(page, "axial_depth_mm", "3")
    expect(page.locator("#log")).to_contain_text("depth 2 -> 3 mm")
    page.reload()
    expect(page.locator("#run-state")).to_have_text("Running")
    expect(page.locator("#in-axial_depth_mm")).to_have_value("3")
    expect(page.locator("#log")).to_contain_text("depth 2 -> 3 mm")
    page.locator("#end").click()
    page.locator("#end-question-no").click()
    expect(page.locator("#run-state")).to_have_text("Running")
    page.locator("#end").click()
    page.locator("#end-question-yes").click()
    expect(page.locator("#run-state")).to_contain_text("Ended")


def test_a_program_runs_under_control(page: Page) -> None:
    program = page.request.post("/v1/programs?example=paper002").json()["id"]
    asked = {"program_id": program, "machine": "vmc15", "material": "c45", "pace": 20.0}
    run = page.request.post("/v1/control-runs", data=asked).json()["id"]
    page.goto(f"/dashboard/control.html?id={run}")
    expect(page.locator("#told-workingstep")).to_contain_text("ROUGH")
    set_input(page, "motor_power_percent", "50")
    expect(page.locator("#log")).to_contain_text("motor power 50 %")
    expect(page.locator("#run-state")).to_contain_text("Program finished")
    expect(page.locator("#lamp")).to_contain_text("AT REST")
    expect(page.locator("#out-feed_actual_mm_min")).to_have_text("0.0")
    # The next start tells programs of the same name apart.
    expect(page.locator("#in-program option").first).to_contain_text(DAY)
    outcomes = page.request.get("/v1/outcomes?program=paper002.stpnc").json()
    assert outcomes["total"] > 0


def running(page: Page, *, pace: float) -> str:
    """A program under control, in its first cut."""
    program = page.request.post("/v1/programs?example=paper002").json()["id"]
    wanted = {"program_id": program, "pace": pace, "is_recorded": False}
    run: str = page.request.post("/v1/control-runs", data=wanted).json()["id"]
    page.goto(f"/dashboard/control.html?id={run}")
    until(lambda: figure(page, "force") > 100.0)
    return run


def status_of(page: Page, run: str) -> dict[str, Any]:
    status: dict[str, Any] = page.request.get(f"/v1/control-runs/{run}/status").json()
    return status


def test_the_operator_holds_and_resumes_and_a_lost_page_changes_nothing(page: Page) -> None:
    run = running(page, pace=2.0)
    expect(page.locator("#no-emergency-stop")).to_contain_text("Not an emergency stop")
    assert page.locator("#out-remaining_s").inner_text() != "–"
    page.locator("#hold").click()
    expect(page.locator("#run-state")).to_have_text("Held")
    expect(page.locator("#out-holding")).to_have_text("held by the operator")
    expect(page.locator("#out-feed_actual_mm_min")).to_have_text("0.0")
    expect(page.locator("#hold")).to_be_disabled()
    expect(page.locator("#log")).to_contain_text("the operator holds the feed")
    keep(page, "control-held")
    page.goto("about:blank")
    before = status_of(page, run)
    until(lambda: status_of(page, run)["time_s"] > before["time_s"] + 1.0)
    assert status_of(page, run)["is_held"]
    assert status_of(page, run)["progress_share"] == before["progress_share"]
    page.goto(f"/dashboard/control.html?id={run}")
    page.locator("#resume").click()
    expect(page.locator("#run-state")).to_have_text("Running")
    until(lambda: figure(page, "feed_actual_mm_min") > 10.0)
    page.request.post(f"/v1/control-runs/{run}/cancel")


def test_the_override_is_lowered_and_ends_at_the_band_of_the_guard(page: Page) -> None:
    run = running(page, pace=2.0)
    slider = page.locator("#in-override_most_percent")
    expect(slider).to_have_attribute("max", "120")
    slider.fill("40")
    expect(page.locator("#override-state")).to_have_text("40 %")
    until(lambda: figure(page, "override_percent") <= 40.0)
    refused = page.request.post(
        f"/v1/control-runs/{run}/changes", data={"override_most_percent": 150.0}
    )
    assert refused.status == 202
    expect(page.locator("#warnings")).to_contain_text("the guard allows at most 120 %")
    assert status_of(page, run)["inputs"]["override_most_percent"] == 40.0
    page.request.post(f"/v1/control-runs/{run}/cancel")


def test_an_alarm_stays_until_it_is_acknowledged(page: Page) -> None:
    """A tooth that breaks is set before Start; nothing but the button takes the alarm away."""
    page.request.post("/v1/programs?example=paper002")
    page.goto("/dashboard/control.html?source=program")
    page.locator("#in-disturbances").fill("tooth:9")
    page.locator("#start").click()
    expect(page.locator("#trouble")).to_contain_text("add a time")
    page.locator("#in-disturbances").fill("tooth:1@8s")
    page.locator("#start").click()
    alarm = page.locator("#alarm-list [data-kind=breakage]")
    expect(alarm).to_contain_text("Tooth broken")
    keep(page, "control-alarm")
    page.reload()
    expect(alarm).to_be_visible()
    kinds = page.locator("#alarms li").evaluate_all("all => all.map(one => one.dataset.kind)")
    for kind in kinds:
        page.locator(f"#alarm-list [data-kind={kind}] button").press("Enter")
    expect(page.locator("#alarms")).to_be_hidden()
    page.reload()
    expect(page.locator("#log [data-kind=breakage]")).to_be_visible()
    expect(page.locator("#alarms")).to_be_hidden()
    page.locator("#alarm-sound").click()
    expect(page.locator("#alarm-sound")).to_have_attribute("aria-pressed", "true")


def test_a_force_above_its_set_point_is_never_green(page: Page) -> None:
    """Sampled in each frame, from the cut into a work that is twice as hard."""
    running(page, pace=1.0)
    page.evaluate(
        """() => { window.seen = { above: 0, green: 0 };
        new MutationObserver(() => {
          const force = document.getElementById("out-force").textContent;
          const share = Number(/([0-9]+) %$/.exec(force)?.[1]);
          if (!(share > 103)) return;
          window.seen.above += 1;
          const lamp = document.getElementById("lamp");
          if (lamp.classList.contains("safe")) window.seen.green += 1;
        }).observe(document.getElementById("glance"), { childList: true, subtree: true }); }"""
    )
    page.locator("#switch-off").click()
    set_input(page, "hardness_percent", "1000")
    until(lambda: page.evaluate("window.seen.above") > 3)
    assert page.evaluate("window.seen.green") == 0
