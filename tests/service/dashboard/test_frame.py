"""The header of all pages: manual, units, keyboard map, order of focus."""

from playwright.sync_api import Page, expect

from tests.service.dashboard.conftest import PHONE, TABLET, WIDE, keep, overflow
from tests.service.dashboard.test_plan import optimised


def test_inch_is_shown_and_remembered(page: Page) -> None:
    optimised(page, "paper002")
    feed = page.locator("#steps tr.step td.n").first
    metric = float(feed.locator("b").inner_text())
    page.locator("#units-shown").click()
    expect(page.locator("#sort-feed")).to_contain_text("in/min")
    assert abs(float(feed.locator("b").inner_text()) * 25.4 / metric - 1.0) < 1e-3
    page.goto("/dashboard/control.html")
    expect(page.locator("[data-name=feed_actual_mm_min] .unit")).to_have_text("in/min")
    page.keyboard.press("u")
    expect(page.locator("[data-name=feed_actual_mm_min] .unit")).to_have_text("mm/min")


def test_the_keyboard_map_opens_and_single_keys_can_be_switched_off(page: Page) -> None:
    page.goto("/dashboard/jobs.html")
    expect(page.locator("#keys")).to_be_visible()
    page.keyboard.press("?")
    expect(page.locator("#key-map")).to_contain_text("page Control")
    page.locator("#keys-on").uncheck()
    page.keyboard.press("Escape")
    expect(page.locator("#key-map")).to_have_count(0)
    page.keyboard.press("2")
    page.keyboard.press("?")
    expect(page.locator("#key-map")).to_be_visible()
    page.locator("#keys-on").check()
    page.keyboard.press("Escape")
    page.keyboard.press("2")
    expect(page).to_have_url("/dashboard/control.html")


def test_focus_goes_from_skip_link_through_the_header_to_the_page(page: Page) -> None:
    page.goto("/dashboard/jobs.html")
    expect(page.locator("#keys")).to_be_visible()
    order = []
    for _ in range(13):
        page.keyboard.press("Tab")
        order.append(page.evaluate("document.activeElement.textContent"))
    pages = ["Plan", "Control", "Machine", "Factory", "Verify", "Knowledge", "Jobs"]
    assert order == ["skip to content", "stepnc", *pages, "Manual", "API", "mm", "?"]


def test_the_manual_opens_from_the_header(page: Page) -> None:
    page.goto("/dashboard/jobs.html")
    page.locator("#manual").click()
    expect(page).to_have_url("/manual/index.html")
    expect(page.locator("body")).to_contain_text("STEP-NC")


def test_a_workingstep_is_a_card_where_the_screen_is_narrow(page: Page) -> None:
    optimised(page, "paper002")
    for size in (TABLET, PHONE):
        page.set_viewport_size(size)
        for part in page.locator("#steps tr.step > *").all():
            box = part.bounding_box()
            assert box is not None
            assert box["x"] + box["width"] <= size["width"]
        assert overflow(page) <= 0
    page.set_viewport_size(WIDE)
    keep(page, "plan-cards")
