"""Verbs called from Python: names, types and bounds are checked as on the command line."""

import logging
from pathlib import Path

import pytest

import stepnc
from service.verbs.call import call, verbs
from stepnc_model.errors import StepNcError
from tests.every_case import every_case

CODE = "G21 G90\nG0 X0 Y0 Z0\nG1 X100 F6000\nM2\n"


@pytest.fixture
def code(tmp_path: Path) -> Path:
    path = tmp_path / "part.ngc"
    path.write_text(CODE, encoding="ascii")
    return path


@every_case(
    ("words", "error", "message"),
    [
        ({"machin": "vmc15"}, TypeError, "no argument 'machin'; near to it: machine"),
        ({"control": "nonsense"}, StepNcError, "unknown control 'nonsense'; known: exact-stop"),
        ({"deviation_mm": -1.0}, StepNcError, "deviation -1 mm: it must be above 0 to 10 mm"),
        ({"deviation_mm": "0.1"}, TypeError, "deviation_mm is a float"),
        ({"most_repeats": 1.5}, StepNcError, "1.5: expected a whole number"),
        ({"most_repeats": True}, TypeError, "most_repeats is a int"),
        ({"machine": None}, TypeError, "machine must not be None"),
        ({"file": "other.ngc"}, TypeError, "got file twice"),
    ],
)
def test_what_is_wrong_is_named(
    code: Path, words: dict[str, object], error: type[Exception], message: str
) -> None:
    with pytest.raises(error, match=message):
        call(verbs()["cycletime"], [code], words)


def test_a_missing_file_and_too_many_are_told() -> None:
    with pytest.raises(TypeError, match="the argument 'file' is missing"):
        call(verbs()["cycletime"], [], {})
    with pytest.raises(TypeError, match="takes 2 positional arguments"):
        call(verbs()["cycletime"], ["a", "b", "c"], {})


def test_a_page_is_written_where_one_is_named(
    code: Path, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    page = tmp_path / "page.html"
    with caplog.at_level(logging.INFO, logger="stepnc"):
        stepnc.cycletime(code, machine="vmc15", report=page)
    assert page.read_text(encoding="utf-8").startswith("<!DOCTYPE html>")
    assert caplog.messages == [f"report: {page}"]


def test_every_verb_is_an_attribute_with_its_help() -> None:
    for verb in verbs().values():
        assert getattr(stepnc, verb.function).__doc__ == verb.about
        assert verb.function in dir(stepnc)
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        stepnc.__getattr__("nothing")
