"""What all tests share: CI draws the same examples each time, a run ends with its skips.

``-m "not slow"`` runs the quick tests, ``--shuffle SEED`` whatever is run in one of all orders,
``--share 0.15`` fifteen of a hundred of them.
"""

import os
import signal
import sys
from collections.abc import Iterator
from pathlib import Path
from random import Random
from typing import Any

import pytest
from hypothesis import HealthCheck, settings

from tests.slow import SLOW

# Workers of pytest-xdist share the cores already: threads of linear algebra would only wait for
# each other, at full speed. Read when numpy is loaded, here and in what tests start.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# readline, which pytest loads, tells its children the size of a terminal that they do not have.
for name in ("COLUMNS", "LINES"):
    os.environ.pop(name, None)

# Where Python writes no bytecode, as in some containers, each process would compile all that it
# loads, and each run of the tests all of them: it goes into the build folder then.
if os.environ.pop("PYTHONDONTWRITEBYTECODE", None):
    folder = str(Path(__file__).parents[1] / "build" / "bytecode")
    sys.pycache_prefix = os.environ.setdefault("PYTHONPYCACHEPREFIX", folder)
    sys.dont_write_bytecode = False

# A shell lets what it starts in the background ignore interrupts, and all that this starts too;
# nohup does the same with the end of the terminal.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)
if signal.getsignal(signal.SIGHUP) is signal.SIG_IGN:
    signal.signal(signal.SIGHUP, signal.SIG_DFL)

# How long an example takes says nothing on a machine that others use as well. Drawn anew, a
# rare one would turn a run of CI red that has nothing to do with the change.
settings.register_profile(
    "project",
    derandomize=bool(os.environ.get("CI")),
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.load_profile("project")

SLOW_PLACES = {Path(__file__).parent / place for place in SLOW}


def pytest_addoption(parser: pytest.Parser) -> None:
    """How to shuffle."""
    parser.addoption("--shuffle", type=int, metavar="SEED", help="shuffle the tests")
    parser.addoption(
        "--share",
        type=float,
        default=1.0,
        metavar="SHARE",
        help="run the first of the shuffled",
    )


def pytest_report_header(config: pytest.Config) -> list[str]:
    """How to run the same order again; no line for each test, whose file is always another."""
    if (seed := config.getoption("shuffle")) is None:
        return []
    config.pluginmanager.getplugin("terminalreporter").showfspath = False
    return [f"order: --shuffle {seed}"]


def is_slow(path: Path) -> bool:
    """True for a module that is listed as slow, or whose folder is."""
    return not SLOW_PLACES.isdisjoint((path, *path.parents))


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Import no module of the tier that does not run: that takes time and memory."""
    unwanted = {"slow": False, "not slow": True}.get(config.getoption("markexpr"))
    if collection_path.suffix == ".py" and is_slow(collection_path) is unwanted:
        return True
    return None


@pytest.hookimpl(wrapper=True)
def pytest_collection_modifyitems(
    config: pytest.Config, items: list[pytest.Item]
) -> Iterator[None]:
    """Mark what is slow before it is selected, and shuffle after pytest has grouped."""
    for item in items:
        if is_slow(item.path):
            item.add_marker(pytest.mark.slow)
    yield
    if (seed := config.getoption("shuffle")) is not None:
        Random(seed).shuffle(items)
        kept = round(config.getoption("share") * len(items))
        config.hook.pytest_deselected(items=items[kept:])
        del items[kept:]


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers(config: pytest.Config) -> int:
    """More workers than cores: tests wait for processes, the slow ones half of their time."""
    cores = os.cpu_count() or 1
    # One more that waits for LinuxCNC, which runs by the clock.
    return 2 * cores + 1 if config.getoption("markexpr") == "slow" else (3 * cores + 1) // 2


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Keep together what shares something, longest first; ``--dist`` asks for another way."""
    if config.getoption("dist") != "load":
        return None
    from tests.distribution import LongestFirst  # noqa: PLC0415 (there may be no xdist)

    return LongestFirst(config, log)


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say that nothing was skipped; what was is listed with its reason by ``-ra``."""
    skipped = terminalreporter.stats.get("skipped", [])
    terminalreporter.section(f"skips: {len(skipped) or 'none'}")
