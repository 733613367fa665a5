"""Bounds that the page about the service gives are those of the program."""

from extras.factory import shop_sources as asked
from extras.factory.requests import MOST_REPLICATIONS
from extras.verification.rest import PLACES_SHOWN
from service.jobs.runner import LONGEST, LONGEST_PACED, MOST_PACED
from service.live.runner import FORGOTTEN_AFTER, MOST_ROWS
from service.live.series import MOST_BYTES
from service.rest.code_check import LONGEST as LONGEST_CHECK
from service.rest.files import LARGEST_TOOLS
from service.rest.settings import Settings
from service.rest.upload_content import MOST_ELEMENTS
from service.rest.upload_content import MOST_ROWS as MOST_LOGGED
from service.simulation.live import MOST_SAMPLES
from service.storage.jobs import MOST_WAITING, OWNERS
from service.verbs.serve.request import USUAL_RATE
from service.web.http_protocol import HEAD_S
from simulator.files.toml_file import MOST_BYTES as MOST_BYTES_OF_TOML
from tests.docs.pages import DOCS


def test_bounds_are_those_of_the_program() -> None:
    page = (DOCS / "service.md").read_text(encoding="utf-8")
    settings = Settings(data="")
    bounds = (
        f"{settings.upload_bytes >> 20} MB (`--upload-mb`)",
        f"{USUAL_RATE:g} requests a second (`--rate`)",
        f"header within {HEAD_S:g} s, body within {settings.body_s:g} s",
        f"{MOST_WAITING} jobs",
        f"{LONGEST / 3600:g} h; {LONGEST_PACED / 3600:g} h for runs",
        f"{MOST_PACED} of them at once",
        f"{MOST_SAMPLES // 1_000_000} million rows or samples; {MOST_BYTES >> 20} MB of rows",
        f"{MOST_LOGGED // 1_000_000} million rows in Parquet, "
        f"{MOST_ELEMENTS // 1_000_000} million elements in XML",
        f"{PLACES_SHOWN // 1000} 000 places",
        f"check of NC code | {LONGEST_CHECK:g} s",
        f"tool table | {LARGEST_TOOLS >> 20} MB; {MOST_BYTES_OF_TOML >> 10} KB in TOML",
        f"{asked.LARGEST >> 10} KB; {asked.MOST_MACHINES} machines, {asked.MOST_STEPS} steps, "
        f"{asked.MOST_RUNS} programs times kinds of machines, {asked.MOST_BATCH // 1000} 000 "
        f"parts a batch; {asked.MOST_HOURS / 1000:g} 000 simulated hours and "
        f"{MOST_REPLICATIONS} replications; {asked.MOST_PARTS // 1_000_000} million parts",
    )
    assert [words for words in bounds if words not in page] == []
    assert (OWNERS, MOST_ROWS, FORGOTTEN_AFTER) == (4, MOST_SAMPLES, 3600.0)
