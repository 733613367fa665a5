"""Jobs that an earlier version has stored are shown as they were, and can still be run.

``former_jobs.sql`` is the database of a data folder with a job of each kind, written before
requests were dataclasses; the second advice is older still, without the newest of its options.
"""

import sqlite3
from pathlib import Path

import pytest

from optimiser.modes import Free, Mode
from service.requests.advice import AdviceRequest
from service.requests.fields import Request, loaded
from service.requests.knowledge import EvaluationRequest, ReviewRequest
from service.requests.runs import ControlRequest, SensorChoice, SimulationRequest
from service.rest.views import job_view
from service.storage import jobs
from service.storage.folder import DataFolder, open_data_folder
from service.storage.jobs import Job, JobKind, JobState
from service.storage.pages import PageCursor
from service.trial.inputs import Inputs, MillingType
from service.trial.request import TrialRequest
from simulator.motion.model_name import ControlModelName
from stepnc_model.editing.file_profile import FileProfile
from stepnc_model.post.dialect import Dialect

FORMER = Path(__file__).with_name("former_jobs.sql").read_text("utf-8")

KINDS: dict[JobKind, type[Request]] = {
    JobKind.ADVICE: AdviceRequest,
    JobKind.SIMULATION: SimulationRequest,
    JobKind.CONTROL: ControlRequest,
    JobKind.TRIAL: TrialRequest,
    JobKind.EVALUATION: EvaluationRequest,
    JobKind.REVIEW: ReviewRequest,
}

NEWER = {JobKind.VERIFICATION, JobKind.CYCLE_TIME, JobKind.FACTORY}
"""Kinds that the earlier version did not have."""


@pytest.fixture
def data_folder(tmp_path: Path) -> DataFolder:
    root = tmp_path / "data"
    root.mkdir(mode=0o700)
    file = sqlite3.connect(root / "service.db")
    file.executescript(FORMER)
    file.close()
    return open_data_folder(root)


def stored(data_folder: DataFolder) -> list[Job]:
    """All jobs, oldest first."""
    return list(jobs.listed(data_folder, PageCursor(limit=100, cursor=None)).items)[::-1]


def test_each_kind_of_job_is_there_and_is_shown(data_folder: DataFolder) -> None:
    found = stored(data_folder)
    assert {job.kind for job in found} == set(KINDS) == set(JobKind) - NEWER
    views = [job_view(job) for job in found]
    assert [view["state"] for view in views] == ["queued"] * 7 + ["failed"]
    assert views[0]["request"]["centre_cutting"] == {"MILL 18MM": True}
    assert views[-1]["problem"]["title"] == "Job lost"


def test_each_request_is_read(data_folder: DataFolder) -> None:
    first, older, simulation, control, trial, evaluation, review, _ = [
        loaded(KINDS[job.kind], job.request) for job in stored(data_folder)
    ]
    assert first == AdviceRequest(
        mode=Mode.QC, machine="vmc15", material="c45", roughness_um=3.2, free=(Free.FEED,),
        workingsteps=("ROUGH THE FACE",), nc_control=Dialect.LINUXCNC, has_pareto=True,
        tool_change_s=30.0, is_confirmed=True, stock="0,0,0,18,300,3", safety=0.8,
        centre_cutting={"MILL 18MM": True}, allow_plunge=True,
        profile=FileProfile.OPTIMISATION,
    )  # fmt: skip
    assert older == AdviceRequest(
        machine="vmc15", material="c45", profile=FileProfile.OPTIMISATION
    )
    assert isinstance(simulation, SimulationRequest)
    assert (simulation.rate_hz, simulation.control) == (50.0, ControlModelName.EXACT_STOP)
    assert isinstance(control, ControlRequest)
    assert (control.sensor, control.disturbances) == (
        SensorChoice.POWER, ("kc:1.3", "power:-50%@12s"),
    )  # fmt: skip
    assert isinstance(trial, TrialRequest)
    assert trial.inputs == Inputs(
        milling_type=MillingType.UP, mode=trial.inputs.mode, is_on=False, teeth=2,
        axial_depth_mm=1.5,
    )  # fmt: skip
    assert isinstance(evaluation, EvaluationRequest)
    assert evaluation.since is not None
    assert isinstance(review, ReviewRequest)
    assert review.material == "c45"


def test_those_that_wait_are_taken_in_their_order(data_folder: DataFolder) -> None:
    waiting = [job.id for job in stored(data_folder) if job.state is JobState.QUEUED]
    taken = [jobs.claim(data_folder) for _ in waiting]
    assert [job and job.id for job in taken] == waiting
    assert jobs.claim(data_folder) is None
