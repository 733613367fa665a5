"""Workingsteps of the shaft, as written and with some of its text replaced."""

from collections.abc import Callable
from pathlib import Path

import pytest

from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.path import ToolPath
from stepnc_model.toolpath.task import ToolPathTask, job_of
from stepnc_model.toolpath.turning.operation import turning_path

SHAFT = Path(__file__).parents[3] / "examples" / "parts" / "shaft.stpnc"


@pytest.fixture(scope="session")
def job() -> Callable[..., ToolPathTask]:
    """A workingstep of the shaft by its name, with edits of before and after."""
    written = SHAFT.read_text(encoding="utf-8")

    def make(name: str, *edits: tuple[str, str]) -> ToolPathTask:
        text = written
        for before, after in edits:
            assert before in text, before
            text = text.replace(before, after)
        program = Program(Part21File.from_bytes(text.encode(), name="shaft"), name="shaft")
        (step,) = (step for step in program.workingsteps if step.id == name)
        return job_of(program, step)

    return make


@pytest.fixture(scope="session")
def path_of(job: Callable[..., ToolPathTask]) -> Callable[..., ToolPath]:
    """The tool path of such a workingstep."""

    def make(name: str, *edits: tuple[str, str]) -> ToolPath:
        return turning_path(job(name, *edits))

    return make
