"""``/v1/advice``: feeds with their reasons, quick to look up."""

from pathlib import Path

import httpx
import pytest

from service.errors import Conflict, NotFound
from service.ids import new_id
from service.rest import advice
from service.rest.advice import AdviceCache, CachedAdvice
from service.storage import jobs
from service.storage.folder import open_data_folder
from service.storage.results import RESULT
from tests.service.rest.conftest import Done
from tests.service.rest.server import is_problem, made, over


def test_the_whole_and_one_workingstep_say_the_same(client: httpx.Client, done: Done) -> None:
    whole = client.get(f"/v1/advice/{done.advice}").json()
    [step] = whole["workingsteps"]
    assert (whole["program"], whole["nc_control"]) == ("part.stpnc", "linuxcnc")
    assert step["advised"]["feed_mm_min"] > step["programmed"]["feed_mm_min"] > 0.0
    assert step["reason"]
    for name in (step["id"], step["instance"].removeprefix("#"), "ROUGH%20THE%20FACE"):
        assert client.get(f"/v1/advice/{done.advice}/workingsteps/{name}").json() == step
    is_problem(client.get(f"/v1/advice/{done.advice}/workingsteps/none"), 404)


def test_a_confirmed_advice_tells_what_its_run_found(client: httpx.Client, done: Done) -> None:
    whole = client.get(f"/v1/advice/{done.advice}").json()
    [step] = whole["confirmation"]["workingsteps"]
    assert step["id"] == whole["workingsteps"][0]["id"]
    assert step["time_s"]["ratio"] == pytest.approx(1.0, abs=0.01)
    assert step["cutting_force_n"]["found"] > 0.0
    assert whole["confirmation"]["passed"] == []


def test_a_run_of_a_machine_without_axes_is_refused(client: httpx.Client, done: Done) -> None:
    body = {"machine": "paper002", "is_confirmed": True}
    job = made(client.post(f"/v1/programs/{done.program}/advice", json=body))
    ended = over(client, job, within=120.0)
    assert ended["state"] == "failed"
    assert "has no data for its axes X, Y, Z" in ended["problem"]["detail"]


def test_answers_are_tagged(client: httpx.Client, done: Done) -> None:
    for path in ("", "/workingsteps/ROUGH THE FACE"):
        answer = client.get(f"/v1/advice/{done.advice}{path}")
        tag = answer.headers["etag"]
        for condition in (tag, f"W/{tag}", f'"x", {tag}', "*"):
            again = client.get(
                f"/v1/advice/{done.advice}{path}", headers={"if-none-match": condition}
            )
            assert (again.status_code, again.content) == (304, b"")
            assert again.headers["etag"] == tag
        other = client.get(f"/v1/advice/{done.advice}{path}", headers={"if-none-match": '"x"'})
        assert other.status_code == 200


def test_program_nc_code_and_report_are_files(client: httpx.Client, done: Done) -> None:
    file = client.get(f"/v1/advice/{done.advice}/file")
    assert file.content.startswith(b"ISO-10303-21;")
    assert "part.optimised.stpnc" in file.headers["content-disposition"]
    code = client.get(f"/v1/advice/{done.advice}/nc")
    assert code.headers["content-type"] == "text/plain; charset=utf-8"
    assert "part.optimised.ngc" in code.headers["content-disposition"]
    other = client.get(f"/v1/advice/{done.advice}/nc?control=heidenhain")
    assert "BEGIN PGM" in other.text
    assert "part.optimised.h" in other.headers["content-disposition"]
    is_problem(client.get(f"/v1/advice/{done.advice}/nc?control=abacus"), 422)
    report = client.get(f"/v1/advice/{done.advice}/report")
    assert report.text.startswith("<!DOCTYPE html>")
    assert "sandbox" in report.headers["content-security-policy"]


def test_another_jobs_id_is_no_advice(client: httpx.Client, done: Done) -> None:
    for path in ("", "/file", "/nc", "/report", "/workingsteps/x"):
        is_problem(client.get(f"/v1/advice/{done.simulation}{path}"), 404)
        is_problem(client.get(f"/v1/advice/{'0' * 26}{path}"), 404)
    listed = client.get("/v1/advice").json()["items"]
    assert {job["kind"] for job in listed} == {"advice"}


def test_the_cache_keeps_few_and_forgets_what_was_deleted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(advice, "MOST_READY", 3)
    data_folder, cache = open_data_folder(tmp_path, knowledge="none.db"), AdviceCache()
    ids = []
    for _ in range(6):
        order = jobs.JobRequest(kind=jobs.JobKind.ADVICE, request={}, owner="a")
        ids.append(jobs.add(data_folder, order).id)
        data_folder.job_folder(ids[-1]).mkdir()
        (data_folder.job_folder(ids[-1]) / RESULT).write_text('{"workingsteps": []}')
        cache.get(data_folder, ids[-1])
    assert len(cache._ready) == 3
    assert cache.get(data_folder, ids[-1]) is cache.get(data_folder, ids[-1])
    jobs.cancel(data_folder, ids[-1])
    jobs.remove(data_folder, ids[-1])
    with pytest.raises(NotFound):
        cache.get(data_folder, ids[-1])
    with pytest.raises(NotFound):
        cache.get(data_folder, new_id())


@pytest.mark.parametrize("is_deleted", [True, False])
def test_a_result_that_goes_between_look_and_read_is_no_fault(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, is_deleted: bool
) -> None:
    data_folder, cache = open_data_folder(tmp_path, knowledge="none.db"), AdviceCache()
    order = jobs.JobRequest(kind=jobs.JobKind.ADVICE, request={}, owner="a")
    id = jobs.add(data_folder, order).id
    job = jobs.claim(data_folder, kinds=[jobs.JobKind.ADVICE])
    assert job is not None
    jobs.finish(data_folder, job, jobs.JobState.SUCCEEDED)
    file = data_folder.job_folder(id) / RESULT
    file.parent.mkdir()
    file.write_text('{"workingsteps": []}')
    read = advice._ready

    def late(name: str, stamp: int) -> CachedAdvice:
        file.unlink()
        if is_deleted:
            jobs.remove(data_folder, id)
        return read(name, stamp)

    monkeypatch.setattr(advice, "_ready", late)
    with pytest.raises(NotFound if is_deleted else Conflict):
        cache.get(data_folder, id)
