"""What all pages share: the frame, the key."""

import json
import re
from collections.abc import Callable

from playwright.sync_api import Browser, Page, Route, expect

from tests.service.dashboard.conftest import WIDE
from tests.service.rest.server import Server

GOOD = "Bearer stepnc_good"


def test_a_page_works_on_its_second_visit_and_after_a_reload(page: Page) -> None:
    """With the browser's cache: what has not changed is not sent again."""
    for _ in range(2):
        page.goto("/dashboard/plan.html")
        for name, controls in (("Jobs", "#jobs-kind"), ("Plan", "#program-example")):
            page.get_by_role("navigation").get_by_role("link", name=name).click()
            expect(page.get_by_role("link", name=name, exact=True)).to_have_attribute(
                "aria-current", "page"
            )
            expect(page.locator(controls)).to_be_visible()
        page.reload()
        expect(page.get_by_role("navigation").get_by_role("link")).to_have_count(7)
        expect(page.locator("#program-example option")).not_to_have_count(1)


def guard(*, may_ask: bool) -> Callable[[Route], None]:
    """As a service with keys answers; who ``may_ask`` has a planner's."""

    def answer(route: Route) -> None:
        request = route.request
        if request.headers.get("authorization") != GOOD:
            refuse(route, 401, "API key needed")
        elif request.method == "POST" and not may_ask:
            refuse(route, 403, "this request needs the role planner; the key has viewer")
        else:
            route.continue_()

    return answer


def refuse(route: Route, status: int, detail: str) -> None:
    """A problem as the service words it."""
    body = {"type": "urn:stepnc:problem:x", "title": "x", "status": status, "detail": detail}
    route.fulfill(status=status, content_type="application/problem+json", body=json.dumps(body))


def test_a_refused_key_is_told_and_a_key_is_changed_and_forgotten(page: Page) -> None:
    page.route(re.compile("/v1/"), guard(may_ask=False))
    page.goto("/dashboard/plan.html")
    title = page.locator("#key-title")
    expect(title).to_have_text("A key is needed")
    for key, told in (("stepnc_wrong", "This key was refused"), ("stepnc_good", None)):
        page.locator("#key-field").fill(key)
        page.locator("#key-use").click()
        if told:
            expect(title).to_have_text(told)
    expect(title).to_have_count(0)
    expect(page.locator("#program-example option")).not_to_have_count(1)
    page.locator("#program-example").select_option("paper002")
    refusal = page.locator("#program-problem [role=alert]")
    expect(refusal).to_contain_text("the key has viewer")
    refusal.get_by_role("button", name="Use another key").click()
    page.locator("#key-leave").click()
    page.locator("#key").click()
    page.locator("#key-forget").click()
    expect(title).to_have_text("A key is needed")
    expect(page.locator("#key")).to_be_hidden()


def test_a_plan_goes_on_when_the_service_comes_back(browser: Browser, served: Server) -> None:
    with browser.new_context(base_url=served.url, viewport=WIDE) as context:
        page = context.new_page()
        page.goto("/dashboard/plan.html")
        page.locator("#program-example").select_option("paper002")
        expect(page.locator("#program-shown")).to_contain_text("paper002.stpnc")
        plan, runs = re.compile("/v1/(jobs|advice)/"), re.compile("/v1/simulations/")
        for away in (plan, runs):
            page.route(away, lambda route: route.abort())
        page.locator("#optimise").click()
        expect(page.locator("#advice-work")).to_contain_text("Connection lost")
        page.unroute(plan)
        expect(page.locator("#steps tr.step").first).to_be_visible(timeout=120_000)
        expect(page.locator("#runs")).to_contain_text("Connection lost")
        page.unroute(runs)
        expect(page.locator("#load-card")).to_be_visible(timeout=120_000)
