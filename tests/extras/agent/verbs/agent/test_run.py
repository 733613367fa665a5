"""``stepnc agent`` as a process."""

import re
import signal
import subprocess
import sys
from pathlib import Path

import httpx
import pytest

from service.cli.interrupts import INTERRUPTED
from service.cli.main import main
from service.errors import BAD_INPUT, OK
from tests.service.waiting import ended

PART = Path(__file__).parents[5] / "examples" / "parts" / "paper000.stpnc"
STEPNC = [sys.executable, "-c", "from service.cli.main import main; main()", "agent"]


def test_a_run_is_served_and_recorded_until_it_is_interrupted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = [str(PART), "--machine", "paper000", "--port", "0", "--speed", "0"]
    with subprocess.Popen([*STEPNC, *words], stderr=subprocess.PIPE, text=True) as process:
        try:
            assert process.stderr is not None
            told = ""
            while "MTConnect agent" not in told:
                told = process.stderr.readline()
                assert told, process.wait()
            found = re.search(r"http://127\.0\.0\.1:\d+", told)
            assert found is not None
            answer = httpx.get(f"{found[0]}/current", timeout=120.0)
            assert answer.status_code == 200
            assert "MTConnectStreams" in answer.text
            output = tmp_path / "run.parquet"
            with pytest.raises(SystemExit) as end:
                main(["record", found[0], "-o", str(output), "--buffered", "--until-completed"])
            assert end.value.code == OK
            assert "365 rows" in capsys.readouterr().out
            process.send_signal(signal.SIGINT)
            ended(process)
            assert process.returncode in {0, INTERRUPTED}
            assert "Traceback" not in process.stderr.read()
        finally:
            process.kill()


def test_puts_schemas_and_a_broker_are_wired(tmp_path: Path) -> None:
    (tmp_path / "MTConnectStreams_2.7.xsd").write_text("<schema/>", encoding="utf-8")
    words = [str(PART), "--machine", "paper000", "--port", "0", "--speed", "0", "--allow-put",
             "--schema-files", str(tmp_path), "--mqtt", "127.0.0.1:1"]  # fmt: skip
    with subprocess.Popen([*STEPNC, *words], stderr=subprocess.PIPE, text=True) as process:
        try:
            assert process.stderr is not None
            told = ""
            while "MTConnect agent: " not in told or "MQTT broker" not in told:
                line = process.stderr.readline()
                assert line, process.wait()
                told += line
            assert "MQTT broker 127.0.0.1:1: not reached" in told
            found = re.search(r"http://127\.0\.0\.1:\d+", told)
            assert found is not None
            answer = httpx.put(f"{found[0]}/paper000?block=G4", timeout=120.0)
            assert answer.text == "<success/>"
            assert ">G4</Block>" in httpx.get(f"{found[0]}/current", timeout=120.0).text
            schema = httpx.get(f"{found[0]}/schemas/MTConnectStreams_2.7.xsd", timeout=120.0)
            assert schema.text == "<schema/>"
            process.send_signal(signal.SIGINT)
            ended(process)
            assert process.returncode in {0, INTERRUPTED}
            rest = process.stderr.read()
            assert "Traceback" not in rest
            assert "MQTT broker" not in rest
        finally:
            process.kill()


def test_bad_words_are_refused_before_anything_listens(
    capsys: pytest.CaptureFixture[str],
) -> None:
    for words in (
        [str(PART), "--machine", "nope", "--port", "0"],
        [str(PART), "--port", "99999"],
        [str(PART), "--schema", "1.9", "--port", "0"],
        [str(PART), "--speed", "-1", "--port", "0"],
        [str(PART), "--schema-files", "absent", "--port", "0"],
        [str(PART), "--mqtt", "shop", "--port", "0"],
        ["--device", "absent.xml", "--adapter", "127.0.0.1:7878", "--port", "0"],
    ):
        with pytest.raises(SystemExit) as end:
            main(["agent", *words])
        assert end.value.code == BAD_INPUT
        assert "error: " in capsys.readouterr().err
