"""The log of every process: whatever goes wrong where nobody catches it is one line of JSON."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from service.storage.folder import open_data_folder
from tests.service.waiting import environment

BEGIN = """
import asyncio, gc, logging, multiprocessing, sys, threading, warnings
from service.processes import log_lines
log_lines.configure("info")
log_lines.report_faults()

class Broken:
    def __del__(self):
        raise ValueError("broken")

def fail():
    raise ValueError("broken")

async def forgotten():
    asyncio.get_running_loop().call_soon(fail)
    task = asyncio.ensure_future(never_retrieved())
    await asyncio.wait([task])
    del task
    gc.collect()

async def never_retrieved():
    fail()

def child(method, *words):
    context = multiprocessing.get_context(method)
    if method == "forkserver":
        context.set_forkserver_preload([log_lines.FORKED])
    process = context.Process(target=log_lines.reported, args=("info", *words))
    process.start()
    process.join()
    assert process.exitcode == log_lines.FAULTY, process.exitcode
"""


def lines_of(folder: Path, script: str, *words: str) -> list[dict[str, Any]]:
    """The log of an interpreter, line by line."""
    ran = subprocess.run(
        [sys.executable, "-c", BEGIN + script, *words],
        env=environment(folder), cwd=folder, capture_output=True, text=True, timeout=120.0,
        check=False,
    )  # fmt: skip
    assert ran.stdout == ""
    return [json.loads(line) for line in ran.stderr.splitlines()]


@pytest.mark.parametrize(
    ("script", "count"),
    [
        ("fail()", 1),
        ("one = threading.Thread(target=fail); one.start(); one.join()", 1),
        ("one = Broken(); del one", 1),
        ("asyncio.run(forgotten())", 2),
        ("""
try:
    fail()
except ValueError:
    logging.getLogger("library").exception("no idea")
""", 1),
        ("child('spawn', int, 'broken')", 1),
        ("child('forkserver', int, 'broken')", 1),
    ],
    ids=("main", "thread", "destructor", "asyncio", "library", "spawned", "forked"),
)  # fmt: skip
def test_an_uncaught_exception_is_one_line(tmp_path: Path, script: str, count: int) -> None:
    lines = lines_of(tmp_path, script)
    assert [(line["event"], line["level"]) for line in lines] == [("fault", "error")] * count
    for line in lines:
        assert line["exception"].startswith("Traceback")
    assert "broken" in lines[0]["exception"]


def test_a_message_without_sense_is_a_fault_and_text_that_is_no_utf_8_is_told(
    tmp_path: Path,
) -> None:
    script = """
logging.getLogger("library").warning("%d of %d", 1)
logging.getLogger("library").warning("file \\udcff")
"""
    fault, told = lines_of(tmp_path, script)
    assert (fault["event"], fault["place"]) == (
        "fault", "log message of library: %d of %d",
    )  # fmt: skip
    assert told["event"] == "file \udcff"


def test_a_warning_is_one_line(tmp_path: Path) -> None:
    [line] = lines_of(tmp_path, "warnings.warn('old', UserWarning)")
    assert line["level"] == "warning"
    assert "UserWarning: old" in line["event"]


def test_a_job_that_cannot_begin_tells_so_in_one_line(tmp_path: Path) -> None:
    open_data_folder(tmp_path / "data")
    script = """
from service.jobs import child as job
from service.storage.folder import FolderAddress
child("forkserver", job.main, FolderAddress(root=sys.argv[1]), "0" * 26, 1)
"""
    [line] = lines_of(tmp_path, script, str(tmp_path / "data"))
    assert line["event"] == "fault"
    assert "NotFound" in line["exception"]


def test_a_web_process_that_cannot_begin_tells_so_in_one_line(tmp_path: Path) -> None:
    script = """
from uvicorn.supervisors.multiprocess import Process
from service.rest.settings import Settings
from service.rest.web_config import WebConfig
Settings(data=sys.argv[1], level="warning").hand_on()
config = WebConfig(
    "service.rest.app:from_environment", factory=True, workers=2, log_config=None, port=0
)
with config.bind_socket() as listening:
    web = Process(config, [listening])
    web.start()
    web.process.join()
    assert web.exitcode == log_lines.FAULTY
"""
    [line] = lines_of(tmp_path, script, str(tmp_path / "none"))
    assert line["event"] == "fault"
    assert "not found in the data folder" in line["exception"]
