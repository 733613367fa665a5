"""Machine: a real machine beside its prediction, through our own agent and client."""

import re
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.extras.agent.model.conftest import BEGIN, ServedAgent, serve
from tests.extras.agent.test_run import PARTS
from tests.service.dashboard.conftest import inside, keep, opened_page
from tests.service.monitor.played import PlayedAgent, looped
from tests.service.rest.server import Server, made, over
from tests.service.waiting import until

__all__ = ["serve"]

PART = PARTS / "paper003_case1.stpnc"

LATE = 30_000
"""ms"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Watched:
    """A service that monitors an agent, with a prediction."""

    agent: PlayedAgent
    server: Server
    simulation: str

    @property
    def path(self) -> str:
        """Of the page."""
        return "/dashboard/machine.html?source=paper003"


@pytest.fixture(scope="module")
def watched(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Watched]:
    folder = tmp_path_factory.mktemp("monitored")
    with (
        PlayedAgent(*looped()) as agent,
        Server(folder, "--agent", f"paper003={agent.url}") as server,
    ):
        with server.client() as client:
            name = "/v1/programs?name=paper003_case1.stpnc"
            program = made(client.post(name, content=PART.read_bytes()), 201)
            asked = {"program_id": program, "machine": "paper003"}
            simulation = made(client.post("/v1/simulations", json=asked))
            assert over(client, simulation)["state"] == "succeeded"
        yield Watched(agent=agent, server=server, simulation=simulation)
        assert server.faults() == ""


@pytest.fixture
def page(
    browser_thread: ThreadPoolExecutor, browser: Browser, watched: Watched
) -> Iterator[Page]:
    with inside(browser_thread, opened_page(browser, watched.server)) as page:
        yield page


def names(page: Page) -> list[str]:
    """Names of the curves."""
    found: list[str] = page.locator("#real-chart").evaluate(
        "(chart) => (chart.data ?? []).map((curve) => curve.name)"
    )
    return found


def points(page: Page) -> int:
    """Number of measured points that are drawn."""
    found: int = page.locator("#real-chart").evaluate(
        "(chart) => chart.data?.[0].x.length ?? 0"
    )
    return found


def test_rows_of_an_agent_are_shown_beside_their_prediction(
    page: Page, watched: Watched
) -> None:
    page.goto("/dashboard/machine.html")
    page.locator("#source").select_option("paper003")
    expect(page.locator("#real-state")).to_have_text("connected")
    expect(page.locator("#real-execution")).to_contain_text(
        re.compile("ACTIVE|WAIT"), timeout=LATE
    )
    expect(page.locator("#real-power")).to_contain_text(re.compile(r"[1-9]"))
    expect(page.locator("#monitor-banner")).to_be_empty()
    before = points(page)
    until(lambda: points(page) > before + 20)
    page.locator("#prediction").select_option(watched.simulation)
    expect(page.locator("#comparison-table tbody tr").first).to_be_visible()
    expect(page.locator("#comparison-table")).to_contain_text("running")
    until(lambda: sum("predicted" in name for name in names(page)) == 6)
    keep(page, "machine-real")
    page.locator("#source").select_option("")
    expect(page.locator("#totals")).to_be_visible()
    assert page.locator("#real-chart").count() == 0


def test_a_banner_says_that_the_data_are_old_until_they_come_back(
    page: Page, watched: Watched
) -> None:
    page.goto(f"{watched.path}&prediction={watched.simulation}")
    banner, values = page.locator("#monitor-banner"), page.locator("#real-values")
    expect(page.locator("#real-power")).to_contain_text(re.compile(r"[1-9]"), timeout=LATE)
    expect(values).not_to_have_class(re.compile("old"))
    watched.agent.stop()
    try:
        expect(banner).to_contain_text(
            re.compile(r"No data from paper003 for [1-9]\d* s: shown values are old\."),
            timeout=LATE,
        )
        expect(banner.get_by_role("alert")).to_be_visible()
        expect(values).to_have_class(re.compile("old"))
        expect(page.locator("#real-state")).to_have_text("lost")
        keep(page, "machine-stale")
    finally:
        watched.agent.start()
    expect(banner).to_be_empty(timeout=LATE)
    expect(values).not_to_have_class(re.compile("old"))
    expect(page.locator("#real-state")).to_have_text("connected")


@pytest.fixture
def silent(
    serve: Callable[..., ServedAgent],
    tmp_path: Path,
    browser_thread: ThreadPoolExecutor,
    browser: Browser,
) -> Iterator[Page]:
    """A page of a machine that is UNAVAILABLE, and of one whose agent is not there."""
    served = serve()
    served.add("vmc15_exec", ["ACTIVE"])
    served.add("vmc15_xpos", [12.5], begin=BEGIN + 1_000_000)
    words = ("--agent", f"vmc15={served.url}/vmc15", "--agent", "lathe22=http://127.0.0.1:9")
    with (
        Server(tmp_path, *words) as server,
        inside(browser_thread, opened_page(browser, server)) as page,
    ):
        yield page


def test_a_machine_that_is_unavailable_or_not_there_says_so(silent: Page) -> None:
    silent.goto("/dashboard/machine.html?source=vmc15")
    banner = silent.locator("#monitor-banner")
    expect(banner).to_contain_text("vmc15 reports that it is UNAVAILABLE")
    expect(silent.locator("#real-x")).to_have_text("12.50")
    expect(silent.locator("#real-values")).to_have_class(re.compile("old"))
    silent.locator("#source").select_option("lathe22")
    expect(banner).to_contain_text("There is no connection to lathe22 yet")
    expect(banner).to_contain_text("Connection refused")
