"""``record`` from Python and its result."""

from pathlib import Path

import pytest

import stepnc
from extras.agent.verbs.record.result import RecordingResult
from service.recording.run import Recording
from stepnc_model.errors import StepNcError


def recorded(*, lost: int) -> RecordingResult:
    return RecordingResult(
        recording=Recording(
            file=Path("run.csv"), rows=12, columns=(), observations=40, lost=lost, restarts=0,
            faults=0,
        )
    )  # fmt: skip


def test_text_tells_of_interruptions_only_if_there_were_any() -> None:
    assert str(recorded(lost=0)) == "run.csv: 12 rows, 0 columns, 40 observations"
    assert str(recorded(lost=3)).endswith("0 restarts of the agent, 3 observations lost")
    assert recorded(lost=3).record()["lost"] == 3


def test_a_bad_name_and_time_are_refused(tmp_path: Path) -> None:
    with pytest.raises(StepNcError, match=r"run\.txt"):
        stepnc.record("http://127.0.0.1:9", output=tmp_path / "run.txt")
    with pytest.raises(StepNcError, match="duration -1 s: it must be"):
        stepnc.record("http://127.0.0.1:9", output=tmp_path / "run.csv", duration_s=-1.0)
