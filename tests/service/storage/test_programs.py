"""Programs: bytes as they came, under an id; a name is words, never a path."""

import hashlib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.errors import Conflict, NotFound, Unavailable
from service.ids import new_id
from service.inputs.program_kind import ProgramKind
from service.storage import jobs, programs
from service.storage.folder import DataFolder
from service.storage.jobs import JobKind, JobRequest, JobState
from service.storage.pages import PageCursor
from service.storage.programs import LONGEST_NAME, shown_name
from stepnc_model.errors import StepNcError


def test_a_program_is_kept_byte_for_byte(data_folder: DataFolder) -> None:
    data = bytes(range(256)) * 10
    made = programs.add(data_folder, data, name="../../part one.stpnc", owner="anna")
    assert data_folder.program_file(made.id).read_bytes() == data
    assert made == programs.get(data_folder, made.id)
    assert (made.name, made.size, made.owner) == ("part one.stpnc", 2560, "anna")
    assert made.sha256 == hashlib.sha256(data).hexdigest()


def test_a_program_of_the_wrong_kind_is_refused_by_its_name(data_folder: DataFolder) -> None:
    code, kind = ProgramKind.NC_CODE, ProgramKind.STEP_NC
    made = programs.add(data_folder, b"G1 X1", name="a.ngc", owner="anna", kind=code)
    assert programs.get(data_folder, made.id).kind is code
    assert programs.require_kind(data_folder, made.id, code) == made
    with pytest.raises(StepNcError, match=r"program 'a\.ngc' is NC code; this needs"):
        programs.require_kind(data_folder, made.id, kind)


def test_pages_go_on_where_they_ended_while_programs_are_added(data_folder: DataFolder) -> None:
    def add() -> str:
        return programs.add(data_folder, b"x", name="x", owner="anna").id

    made = sorted((add() for _ in range(5)), reverse=True)
    first = programs.listed(data_folder, PageCursor(limit=2))
    add()
    second = programs.listed(data_folder, PageCursor(limit=2, cursor=first.cursor))
    third = programs.listed(data_folder, PageCursor(limit=2, cursor=second.cursor))
    shown = [each.id for page in (first, second, third) for each in page.items]
    assert shown == made
    assert third.cursor is None


def test_a_program_that_is_worked_on_stays(data_folder: DataFolder) -> None:
    made = programs.add(data_folder, b"x", name="x", owner="anna")
    job = jobs.add(
        data_folder, JobRequest(kind=JobKind.ADVICE, request={}, program=made.id, owner="anna")
    )
    with pytest.raises(Conflict, match=job.id):
        programs.remove(data_folder, made.id)
    jobs.cancel(data_folder, job.id)
    programs.remove(data_folder, made.id)
    assert not data_folder.program_file(made.id).exists()
    with pytest.raises(NotFound):
        programs.get(data_folder, made.id)
    with pytest.raises(NotFound):
        programs.remove(data_folder, made.id)
    assert jobs.get(data_folder, job.id).state is JobState.CANCELLED


def test_bytes_that_are_gone_are_told(data_folder: DataFolder) -> None:
    made = programs.add(data_folder, b"x", name="x", owner="anna")
    programs.require_file(data_folder, made.id)
    data_folder.program_file(made.id).unlink()
    with pytest.raises(NotFound, match=f"no file of program '{made.id}'"):
        programs.require_file(data_folder, made.id)
    programs.remove(data_folder, made.id)
    with pytest.raises(NotFound, match=f"no program '{made.id}'"):
        programs.require_file(data_folder, made.id)


def test_no_job_is_queued_for_a_program_that_is_gone(data_folder: DataFolder) -> None:
    order = JobRequest(kind=JobKind.ADVICE, request={}, program=new_id(), owner="anna")
    with pytest.raises(NotFound, match="program"):
        jobs.add(data_folder, order)


def test_what_could_not_be_listed_leaves_no_file(
    data_folder: DataFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    with data_folder.database.writing() as connection:
        connection.execute("DROP TABLE programs")
    with pytest.raises(Unavailable):
        programs.add(data_folder, b"x", name="x", owner="anna")
    assert list((data_folder.root / "programs").iterdir()) == []


Names = st.one_of(
    st.text(max_size=200),
    st.lists(st.sampled_from(["..", ".", "/", "\\", "a", " ", "\0", "\n", "C:", "\u202e"])).map(
        "".join
    ),
)


@given(Names)
def test_no_name_is_a_path_or_breaks_a_line(name: str) -> None:
    shown = shown_name(name)
    assert shown
    assert shown.isprintable()
    assert not set(shown) & set("/\\\0\n\r")
    assert shown not in {".", ".."}
    assert shown == shown.strip(". ")
    assert len(shown) <= LONGEST_NAME
    shown.encode()
    assert shown_name(shown) == shown


def test_a_name_of_which_nothing_is_left_is_the_usual_one() -> None:
    assert {shown_name(name) for name in ("", "..", "a/", "\0\n", " . ")} == {"program.stpnc"}
