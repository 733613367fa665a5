"""What all tests share: CI draws the same examples each time, a run ends with its skips."""

import os

import pytest
from hypothesis import HealthCheck, settings

# Drawn anew, a rare example would turn a run red that has nothing to do with the change, and
# how long one takes says nothing on a machine that others use as well.
settings.register_profile(
    "ci",
    derandomize=True,
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow],
)
if os.environ.get("CI"):
    settings.load_profile("ci")


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say that nothing was skipped; what was is listed with its reason by ``-ra``."""
    skipped = terminalreporter.stats.get("skipped", [])
    terminalreporter.section(f"skips: {len(skipped) or 'none'}")
