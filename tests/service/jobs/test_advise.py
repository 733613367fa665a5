"""The job ``advice``: all that may be asked about it lies in its folder."""

import json

from service.inputs.program_kind import ProgramKind
from service.storage import programs
from service.storage.files import FileKind, FileUpload
from service.storage.jobs import JobKind, JobState
from service.storage.results import CURVES, FEEDS, NC_CODE, OPTIMISED, REPORT, RESULT
from stepnc_model.part21.reader import Part21File
from tests.service.jobs.conftest import Shop
from tests.service.rest.samples import CODE, CODE_STOCK, CODE_TOOLS


def test_advice_leaves_a_result_a_program_nc_code_and_a_report(shop: Shop) -> None:
    id = shop.order(JobKind.ADVICE, machine="paper002", nc_control="linuxcnc").id
    job = shop.over(id)
    assert (job.state, job.share, job.problem) == (JobState.SUCCEEDED, 1.0, None)
    folder = shop.data_folder.job_folder(id)
    assert {each.name for each in folder.iterdir()} == {RESULT, OPTIMISED, NC_CODE, REPORT}
    result = json.loads((folder / RESULT).read_bytes())
    assert (result["program"], result["is_written"]) == ("paper002.stpnc", True)
    assert result["nc_control"] == "linuxcnc"
    assert all(step["advised"] for step in result["workingsteps"])
    Part21File.from_bytes((folder / OPTIMISED).read_bytes(), name="x")
    assert str(shop.data_folder.root) not in (folder / RESULT).read_text(encoding="utf-8")
    assert str(shop.data_folder.root) not in (folder / REPORT).read_text(encoding="utf-8")


def test_advice_on_code_leaves_code_feeds_and_curves(shop: Shop) -> None:
    program = programs.add(
        shop.data_folder, CODE, name="plate.nc", owner="anna", kind=ProgramKind.NC_CODE
    ).id
    with FileUpload(shop.data_folder, FileKind.TOOLS, "plate.csv") as upload:
        upload.write(CODE_TOOLS)
        upload.close()
        tools = upload.keep(owner="anna").id
    id = shop.order(
        JobKind.ADVICE,
        program,
        machine="vmc15",
        material="c45",
        stock=CODE_STOCK,
        tools_id=tools,
    ).id
    job = shop.over(id)
    assert (job.state, job.problem) == (JobState.SUCCEEDED, None)
    folder = shop.data_folder.job_folder(id)
    assert {each.name for each in folder.iterdir()} == {RESULT, NC_CODE, REPORT, FEEDS, CURVES}
    for name in (RESULT, REPORT, NC_CODE):
        text = (folder / name).read_text(encoding="utf-8")
        assert str(shop.data_folder.root) not in text
        assert program not in text
    result = json.loads((folder / RESULT).read_bytes())
    assert (result["program"], result["nc_control"]) == ("plate.nc", "fanuc")


def test_a_machine_that_is_none_is_a_problem_with_a_name(shop: Shop) -> None:
    job = shop.over(shop.order(JobKind.ADVICE, machine="../../etc/passwd").id)
    assert job.state is JobState.FAILED
    assert job.problem is not None
    assert job.problem["type"] == "urn:stepnc:problem:unknown-machine"
    assert job.problem["name"] == "../../etc/passwd"
    assert "vmc15" in job.problem["known"]
