"""What all tests share: CI draws the same examples each time, a run ends with its skips."""

import os

import pytest
from hypothesis import HealthCheck, settings

# Workers of pytest-xdist share the cores already: threads of linear algebra would only wait for
# each other, at full speed. Read when numpy is loaded, here and in what tests start.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# How long an example takes says nothing on a machine that others use as well. Drawn anew, a
# rare one would turn a run of CI red that has nothing to do with the change.
settings.register_profile(
    "project",
    derandomize=bool(os.environ.get("CI")),
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.load_profile("project")


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say that nothing was skipped; what was is listed with its reason by ``-ra``."""
    skipped = terminalreporter.stats.get("skipped", [])
    terminalreporter.section(f"skips: {len(skipped) or 'none'}")
