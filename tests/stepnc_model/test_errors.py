"""One tree of errors; messages name the place as an editor shows it."""

import pytest

from optimiser.errors import OptimisationError
from simulator.errors import SimulationError
from stepnc_model.errors import (
    Finding,
    Part21Error,
    SchemaError,
    Severity,
    StepNcError,
    WriteError,
)


@pytest.mark.parametrize(
    "branch", [Part21Error, SchemaError, WriteError, SimulationError, OptimisationError]
)
def test_every_branch_hangs_on_one_root(branch: type[Exception]) -> None:
    assert issubclass(branch, StepNcError)


def test_the_root_is_no_error_of_a_caller() -> None:
    assert not issubclass(StepNcError, (ValueError, TypeError))


def test_a_syntax_error_names_line_and_column() -> None:
    error = Part21Error("found ';', expected ')'", line=12, column=7)
    assert str(error) == "line 12, column 7: found ';', expected ')'"
    assert (error.line, error.column) == (12, 7)


def test_a_schema_error_names_line_instance_and_attribute() -> None:
    error = SchemaError("has no tool", entity="#19 DRILLING", attribute="its_tool", line=30)
    assert str(error) == "line 30: #19 DRILLING.its_tool: has no tool"
    assert (error.entity, error.attribute, error.line) == ("#19 DRILLING", "its_tool", 30)


def test_a_schema_error_without_attribute_names_the_instance() -> None:
    assert str(SchemaError("is odd", entity="#1 X")) == "#1 X: is odd"


def test_a_schema_error_about_the_whole_file_is_its_message() -> None:
    assert str(SchemaError("no main workplan")) == "no main workplan"


def test_a_write_error_names_the_path() -> None:
    error = WriteError("disk full", path="out.stpnc")
    assert str(error) == "out.stpnc: disk full"
    assert error.path == "out.stpnc"


def test_a_finding_reads_as_one_line() -> None:
    finding = Finding(
        severity=Severity.WARNING,
        message="too fast",
        entity="#4 MILLING_TECHNOLOGY",
        attribute="spindle",
        line=9,
        rule="ISO 14649-10",
    )
    text = "warning: line 9: #4 MILLING_TECHNOLOGY.spindle: too fast (ISO 14649-10)"
    assert str(finding) == text


def test_a_finding_about_the_whole_file_is_severity_and_message() -> None:
    assert str(Finding(severity=Severity.NOTE, message="guessed")) == "note: guessed"
