"""What all tests share: a run ends by saying what was skipped."""

import pytest


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say that nothing was skipped; what was is listed with its reason by ``-ra``."""
    skipped = terminalreporter.stats.get("skipped", [])
    terminalreporter.section(f"skips: {len(skipped) or 'none'}")
