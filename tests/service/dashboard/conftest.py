"""The dashboard in a real browser, on a service of its own; pictures in build/screenshots.

Playwright keeps an event loop running in the thread that started it, between its calls too:
there ``asyncio.run`` fails for everybody else. All that touches the browser, the tests of this
folder included, therefore runs in a thread of its own.
"""

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractContextManager, contextmanager
from functools import partial
from inspect import signature
from typing import TypeVar

import pytest
from playwright.sync_api import (
    Browser,
    ConsoleMessage,
    Page,
    ViewportSize,
    expect,
    sync_playwright,
)

from kbe.store import open_store
from tests.debian import installed
from tests.service.rest.server import Server
from tests.service.shop import outcomes
from tests.service.waiting import ROOT, until

PATIENCE = 120_000.0
"""ms, on a busy machine"""

expect.set_options(timeout=PATIENCE)

FLAGS = [
    "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-sync",
    "--disable-background-networking", "--disable-component-update",
    "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
]  # fmt: skip

SCREENSHOTS = ROOT / "build" / "screenshots"

WIDE: ViewportSize = {"width": 1280, "height": 800}
TABLET: ViewportSize = {"width": 820, "height": 1180}
PHONE: ViewportSize = {"width": 390, "height": 844}

T = TypeVar("T")


@pytest.fixture(scope="session", autouse=True)
def browser_thread() -> Iterator[ThreadPoolExecutor]:
    """The one thread that touches the browser."""
    with ThreadPoolExecutor(max_workers=1, thread_name_prefix="browser") as thread:
        yield thread


@pytest.hookimpl(tryfirst=True)
def pytest_pyfunc_call(pyfuncitem: pytest.Function) -> bool:
    """Run the tests of this folder in the thread of the browser."""
    wanted = {name: pyfuncitem.funcargs[name] for name in signature(pyfuncitem.obj).parameters}
    thread = pyfuncitem.funcargs["browser_thread"]
    assert isinstance(thread, ThreadPoolExecutor)
    thread.submit(pyfuncitem.obj, **wanted).result()
    return True


@contextmanager
def inside(thread: ThreadPoolExecutor, context: AbstractContextManager[T]) -> Iterator[T]:
    """A context that is entered and left in another thread."""
    yield thread.submit(context.__enter__).result()
    thread.submit(context.__exit__, None, None, None).result()


@pytest.fixture(scope="session")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    server = Server(tmp_path_factory.mktemp("dashboard"), "--jobs", "2")
    server.data.mkdir(parents=True)
    with open_store(str(server.data / "knowledge.db")) as store:
        store.add(list(outcomes(60)))
    with server:
        yield server


@pytest.fixture(scope="session")
def browser(browser_thread: ThreadPoolExecutor) -> Iterator[Browser]:
    with inside(browser_thread, opened_browser(installed("chromium", "chromium"))) as browser:
        yield browser


@contextmanager
def opened_browser(program: str) -> Iterator[Browser]:
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=FLAGS)
        yield browser
        browser.close()


@pytest.fixture
def page(
    browser_thread: ThreadPoolExecutor, browser: Browser, served: Server
) -> Iterator[Page]:
    with inside(browser_thread, opened_page(browser, served)) as page:
        yield page


@contextmanager
def opened_page(browser: Browser, served: Server) -> Iterator[Page]:
    """A page that must say nothing wrong: no error, nothing that the policy refuses."""
    context = browser.new_context(
        base_url=served.url, viewport=WIDE, accept_downloads=True, reduced_motion="reduce"
    )
    page = context.new_page()
    page.set_default_timeout(PATIENCE)
    # Requests beside the page do not take its patience.
    for method in ("get", "post"):
        send = partial(getattr(context.request, method), timeout=PATIENCE)
        setattr(context.request, method, send)
    said: list[str] = []
    page.on("pageerror", lambda error: said.append(f"error: {error}"))
    page.on(
        "console",
        lambda message: said.append(message.text) if is_fault(message) else None,
    )
    foreign: list[str] = []
    page.on(
        "request",
        lambda request: (
            None
            if request.url.startswith((served.url, "blob:", "data:"))
            else foreign.append(request.url)
        ),
    )
    yield page
    context.close()
    assert said == []
    assert foreign == []


def is_fault(message: ConsoleMessage) -> bool:
    """Whether the browser complains; of answers that refuse something it always does."""
    refused = "the server responded with a status of 4"
    return message.type == "error" and refused not in message.text


def keep(page: Page, name: str) -> None:
    """Screenshots of a page: on a wide screen light and dark, on a tablet, on a phone."""
    SCREENSHOTS.mkdir(parents=True, exist_ok=True)
    page.evaluate("scrollTo(0, 0)")
    for kind, size in (("wide", WIDE), ("tablet", TABLET), ("phone", PHONE)):
        page.set_viewport_size(size)
        # Plots follow the window a moment later.
        until(lambda: overflow(page) <= 0)
        page.screenshot(path=SCREENSHOTS / f"{name}-{kind}.png", full_page=kind != "wide")
    page.set_viewport_size(WIDE)
    page.evaluate("localStorage.setItem('stepnc.theme', 'dark')")
    page.get_by_role("button", name="switch between light and dark").click()
    page.get_by_role("button", name="switch between light and dark").click()
    page.screenshot(path=SCREENSHOTS / f"{name}-dark.png")
    page.get_by_role("button", name="switch between light and dark").click()


def overflow(page: Page) -> int:
    """Pixels by which the page is wider than the screen."""
    found: int = page.evaluate(
        "document.documentElement.scrollWidth - document.documentElement.clientWidth"
    )
    return found
