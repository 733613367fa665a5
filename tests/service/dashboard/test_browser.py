"""The browser harms no test that comes after it."""

import asyncio

import pytest
from playwright.sync_api import Browser


@pytest.fixture
def answer(browser: Browser) -> str:
    """Of an event loop in the thread of all other tests, while the browser is open."""
    assert browser.is_connected()
    return asyncio.run(asyncio.sleep(0.0, "answer"))


def test_an_open_browser_leaves_event_loops_to_other_tests(answer: str) -> None:
    assert answer == "answer"
