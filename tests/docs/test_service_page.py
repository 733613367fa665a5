"""The commands of the page about the service are run, in order, against a service."""

import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.docs.pages import DOCS, ROOT, blocks
from tests.service.rest.server import Server

PAGE = (DOCS / "service.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    with Server(tmp_path_factory.mktemp("page")) as server:
        yield server


def script(url: str) -> str:
    """All that is done with curl, as one script that stops at the first failure."""
    parts = [block.text for block in blocks(PAGE) if block.language == "sh"]
    text = "\n".join(part for part in parts if "curl" in part or "URL=" in part)
    assert text.count("curl ") > 12
    return text.replace("http://127.0.0.1:8000", url).replace("curl ", "curl --fail -m 60 ")


def test_the_commands_do_what_the_page_says(served: Server, tmp_path: Path) -> None:
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    done = subprocess.run(
        ["bash", "-euo", "pipefail", "-c", script(served.url)],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=240,
        check=False,
    )
    assert done.returncode == 0, done.stderr + done.stdout[-2000:]
    assert "feed_mm_min" in done.stdout
    assert '"signals":{"total_power_w"' in done.stdout
    optimised = (tmp_path / "part.optimised.stpnc").read_text(encoding="utf-8")
    assert optimised.startswith("ISO-10303-21;")
    assert "G1" in (tmp_path / "part.ngc").read_text(encoding="utf-8")
    assert (tmp_path / "feeds.csv").read_text(encoding="utf-8").startswith("block,part,")
    assert '"control":"linuxcnc"' in done.stdout
    rewritten = (tmp_path / "part.optimised.ngc").read_text(encoding="utf-8")
    given = (tmp_path / "part.ngc").read_text(encoding="utf-8")
    assert rewritten.count("\n") > given.count("\n")
    assert '"verdict":"nothing beyond the uncertainty of the log"' in done.stdout
    assert (tmp_path / "places.csv").read_text(encoding="utf-8").startswith('"x_mm"')


def test_the_example_client_shows_a_feed_and_a_run(served: Server) -> None:
    done = subprocess.run(
        [sys.executable, "examples/04_rest_client.py", served.url],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=240,
        check=True,
    )
    feed, size, run = done.stdout.splitlines()
    assert re.fullmatch(r"ROUGH THE FACE: 164\.6 mm/min, tool deflection .*", feed)
    assert size.startswith("optimised program: ")
    assert re.fullmatch(r"simulated: 127\.\d s, 319\.\d kJ, told in \d+ events", run)
