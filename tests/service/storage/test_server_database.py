"""A database on a server: one schema, clear refusals, and a server that goes and comes back."""

import os
import subprocess
import sys
from pathlib import Path
from threading import Barrier, Thread
from time import monotonic

import psycopg
import pytest
from sqlalchemy.engine import make_url

from service.errors import Conflict, NotFound, Unavailable
from service.storage import jobs, programs, server_database
from service.storage.database import FileDatabase
from service.storage.files import FileKind, FileUpload
from service.storage.folder import (
    DataFolder,
    FolderAddress,
    known_data_folder,
    open_data_folder,
    require_shared_files,
    show_attempt,
)
from service.storage.jobs import JobKind, JobRequest, JobState
from service.storage.server_database import ServerDatabase
from service.storage.server_schema import PACED, SCHEMA
from tests.postgres import Server, ServerMaker
from tests.service.waiting import ROOT, until

ORDER = JobRequest(kind=JobKind.REVIEW, request={}, owner="anna")


def columns(database: FileDatabase | ServerDatabase, table: str) -> list[str]:
    with database.writing() as connection:
        assert connection.execute(f"SELECT * FROM {table}").fetchall() == []
        if isinstance(database, FileDatabase):
            found = connection.execute("SELECT name FROM pragma_table_info(?)", (table,))
        else:
            found = connection.execute(
                "SELECT column_name AS name FROM information_schema.columns "
                "WHERE table_name = ? ORDER BY ordinal_position",
                (table,),
            )
        return [row["name"] for row in found.fetchall()]


def test_both_databases_have_the_same_tables(tmp_path: Path, new_database: str) -> None:
    file, server = FileDatabase(tmp_path / "service.db"), ServerDatabase(new_database)
    for table in ("programs", "files", "requests", "keys", "runner"):
        assert columns(file, table) == columns(server, table), table
    # A file has row ids of its own, and a column that came later stands last.
    assert sorted([*columns(file, "jobs"), "rowid"]) == sorted(columns(server, "jobs"))


@pytest.mark.parametrize("kind", JobKind)
@pytest.mark.parametrize("pace", [None, 0.0, 2.0])
def test_each_kind_of_work_is_claimed_alike_by_both_databases(
    data_folder: DataFolder, kind: JobKind, pace: float | None
) -> None:
    words = {} if pace is None else {"pace": pace}
    made = jobs.add(data_folder, JobRequest(kind=kind, request=words, owner="anna"))
    is_paced = jobs.get(data_folder, made.id).is_paced
    if pace and kind not in PACES:
        # No request of these has a pace.
        return
    assert jobs.claim(data_folder, is_paced=not is_paced) is None
    claimed = jobs.claim(data_folder, is_paced=is_paced)
    assert claimed is not None
    jobs.recover(data_folder, [claimed])
    # People were in a live run; others begin again.
    live = {JobKind.CONTROL, JobKind.TRIAL} | ({JobKind.FACTORY} if pace else set())
    wanted = JobState.FAILED if kind in live else JobState.QUEUED
    assert jobs.get(data_folder, made.id).state is wanted


PACES = {JobKind.CONTROL, JobKind.TRIAL, JobKind.SIMULATION, JobKind.FACTORY}


def test_a_migration_that_breaks_off_leaves_nothing_and_a_whole_one_keeps_all(
    new_database: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    data_folder = open_data_folder(tmp_path, database=new_database)
    kept = jobs.add(data_folder, ORDER)
    more = ("ALTER TABLE jobs ADD COLUMN note TEXT NOT NULL DEFAULT ''",)
    for script, is_good in (((*more, "CREATE nonsense"), False), (more, True)):
        monkeypatch.setattr(server_database, "SCHEMA", (*SCHEMA, script))
        if is_good:
            ServerDatabase(new_database).close()
        else:
            with pytest.raises(Unavailable):
                ServerDatabase(new_database)
        with psycopg.connect(new_database) as connection:
            row = connection.execute(
                "SELECT max(number), (SELECT count(*) FROM information_schema.columns "
                "WHERE table_schema = 'stepnc_service' AND column_name = 'note') "
                "FROM stepnc_service.version"
            ).fetchone()
        assert row == (len(SCHEMA) + is_good, int(is_good))
    # A host that still runs the former program goes on.
    assert jobs.get(data_folder, kept.id) == kept


def test_a_claim_reads_only_the_index_of_what_waits(new_database: str) -> None:
    assert PACED == jobs.PACED
    database = ServerDatabase(new_database)
    for condition in (PACED, f"NOT {PACED}"):
        with database.writing() as connection:
            connection.execute("SET LOCAL enable_seqscan = off")
            plan = connection.execute(
                "EXPLAIN SELECT id FROM jobs WHERE state = 'queued' AND kind IN ('review') "
                f"AND {condition} ORDER BY rowid LIMIT 1 FOR UPDATE SKIP LOCKED"
            ).fetchall()
        assert "using jobs_waiting" in str(plan)


def test_pages_are_cut_by_bytes_whatever_the_language_of_the_server(
    new_database: str,
) -> None:
    with ServerDatabase(new_database).reading() as connection:
        row = connection.execute(
            "SELECT count(*) AS n FROM information_schema.columns WHERE table_schema = "
            "'stepnc_service' AND column_name = 'id' AND collation_name = 'C' "
            "AND table_name IN ('programs', 'jobs', 'files', 'keys')"
        ).fetchone()
    assert row["n"] == 4


def test_hosts_that_open_a_new_database_at_once_both_succeed(new_database: str) -> None:
    barrier, made = Barrier(4), list[ServerDatabase]()

    def open_it() -> None:
        barrier.wait(120.0)
        made.append(ServerDatabase(new_database))

    threads = [Thread(target=open_it) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(120.0)
    assert len(made) == 4
    with made[0].reading() as connection:
        rows = connection.execute("SELECT number FROM version").fetchall()
    assert [row["number"] for row in rows] == [number + 1 for number in range(len(SCHEMA))]


def test_a_newer_database_is_refused(new_database: str) -> None:
    with ServerDatabase(new_database).writing() as connection:
        connection.execute("INSERT INTO version VALUES (?)", (len(SCHEMA) + 1,))
    told = f"of version {len(SCHEMA) + 1}; this program supports up to {len(SCHEMA)}"
    with pytest.raises(Unavailable, match=told):
        ServerDatabase(new_database)


@pytest.mark.parametrize(
    ("url", "told"),
    [
        ("sqlite:///x.db", "--database sqlite://…: write postgresql://USER@HOST/DATABASE"),
        ("x.db", "--database a file name: write postgresql://"),
        ("postgresql://u:p@ss@h/d", "is not a valid address"),
        ("postgresql://u:sesame@127.0.0.1:1/d", "cannot connect to the server"),
        ("postgresql://u:sesame@nowhere.invalid/d", "cannot connect to the server"),
    ],
)
def test_an_address_that_leads_nowhere_is_told_without_its_password(
    url: str, told: str, tmp_path: Path
) -> None:
    with pytest.raises(Exception, match=told) as refused:
        open_data_folder(tmp_path / "data", database=url)
    assert "sesame" not in str(refused.value)
    assert "p@ss" not in str(refused.value)


def test_a_wrong_password_and_a_missing_database_are_told(
    new_server: ServerMaker, tmp_path: Path
) -> None:
    server = new_server()
    with psycopg.connect(server.url, autocommit=True) as connection:
        connection.execute("CREATE ROLE shop LOGIN PASSWORD 'right'")
    settings = server.folder / "data" / "pg_hba.conf"
    settings.write_text(f"local all shop scram-sha-256\n{settings.read_text('utf-8')}", "utf-8")
    server.run("pg_ctl", "reload")
    wrong = make_url(server.url).set(username="shop", password="sesame")
    with pytest.raises(Unavailable, match="password authentication failed") as refused:
        open_data_folder(tmp_path, database=wrong.render_as_string(hide_password=False))
    assert "sesame" not in str(refused.value)
    missing = make_url(server.url).set(database="none").render_as_string()
    with pytest.raises(Unavailable, match='database "none" does not exist'):
        open_data_folder(tmp_path, database=missing)


WITHOUT = """
import sys
sys.modules["psycopg"] = None
from service.cli.main import main
main(["keys", "list", "--data", sys.argv[1], "--database", "postgresql://u@h/d"])
"""


def test_a_driver_that_is_not_installed_is_named(tmp_path: Path) -> None:
    ended = subprocess.run(
        [sys.executable, "-c", WITHOUT, str(tmp_path)],
        capture_output=True, text=True, timeout=120.0, check=False,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    assert ended.returncode not in {0, None}
    assert "pip install 'stepnc-optimiser[postgres]'" in ended.stderr
    assert "Traceback" not in ended.stderr


@pytest.fixture
def own_server(new_server: ServerMaker) -> Server:
    """A server that may be stopped."""
    return new_server()


def test_a_server_that_was_away_is_used_again(
    own_server: Server, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    data_folder = open_data_folder(tmp_path, database=own_server.url)
    kept = jobs.add(data_folder, ORDER)
    own_server.stop("immediate")
    for _ in range(2):
        with pytest.raises(Unavailable, match="the database does not answer") as refused:
            jobs.get(data_folder, kept.id)
        assert str(own_server.folder) not in str(refused.value)
    # While it is away, nobody waits for it.
    monkeypatch.setattr(server_database, "PAUSE", 600.0)
    begin = monotonic()
    with pytest.raises(Unavailable):
        jobs.get(data_folder, kept.id)
    assert monotonic() - begin < 120.0
    monkeypatch.setattr(server_database, "PAUSE", 0.0)
    own_server.start()
    assert jobs.get(data_folder, kept.id) == kept


def test_a_connection_that_broke_while_idle_is_replaced_unseen(
    new_database: str, tmp_path: Path
) -> None:
    data_folder = open_data_folder(tmp_path, database=new_database)
    kept = jobs.add(data_folder, ORDER)
    with psycopg.connect(new_database, autocommit=True) as other:
        other.execute(
            "SELECT pg_terminate_backend(pid, 5000) FROM pg_stat_activity "
            "WHERE application_name = 'stepnc' AND datname = current_database()"
        )
    assert jobs.get(data_folder, kept.id) == kept


def test_no_job_is_queued_for_a_program_that_is_being_deleted(
    new_database: str, tmp_path: Path
) -> None:
    data_folder = open_data_folder(tmp_path, database=new_database)
    program = programs.add(data_folder, b"x", name="x", owner="anna").id
    order = JobRequest(kind=JobKind.ADVICE, request={}, program=program, owner="anna")
    said: list[type[Exception]] = []

    def add() -> None:
        try:
            jobs.add(data_folder, order)
        except NotFound as error:
            said.append(type(error))

    thread = Thread(target=add)
    with data_folder.database.writing() as connection:
        connection.lock(f"program {program}")
        thread.start()
        until(lambda: waits(new_database))
        connection.execute("DELETE FROM programs WHERE id = ?", (program,))
    thread.join(120.0)
    assert said == [NotFound]
    program = programs.add(data_folder, b"x", name="x", owner="anna").id
    job = jobs.add(data_folder, JobRequest(kind=JobKind.ADVICE, request={}, program=program,
                                           owner="anna"))  # fmt: skip
    with pytest.raises(Conflict, match=job.id):
        programs.remove(data_folder, program)


def waits(url: str) -> bool:
    """Whether somebody waits for a lock of the database."""
    with psycopg.connect(url) as connection:
        row = connection.execute(
            "SELECT count(*) FROM pg_locks WHERE NOT granted AND locktype = 'advisory'"
        ).fetchone()
    return row is not None and row[0] > 0


def test_a_refusal_of_the_server_is_no_lack_of_answer(
    new_database: str, tmp_path: Path
) -> None:
    data_folder = open_data_folder(tmp_path, database=new_database)
    with (
        pytest.raises(Unavailable, match="the database refuses: UndefinedTable"),
        data_folder.database.reading() as connection,
    ):
        connection.execute("SELECT 1 FROM nothing")


def hosts(url: str, folder: Path) -> tuple[DataFolder, DataFolder]:
    """Two hosts that share their files."""
    first, second = (
        open_data_folder(folder / name, database=url, files=str(folder / "shared"))
        for name in ("a", "b")
    )
    return first, second


def test_hosts_that_do_not_share_their_files_are_refused(
    new_database: str, tmp_path: Path
) -> None:
    first, second = hosts(new_database, tmp_path)
    require_shared_files(first)
    require_shared_files(second)
    alone = open_data_folder(tmp_path / "c", database=new_database)
    with pytest.raises(Unavailable, match="name the folder that they share with --files"):
        require_shared_files(alone)
    address = FolderAddress(root=str(tmp_path / "a"), database=new_database, files="nowhere")
    with pytest.raises(Unavailable, match="not found"):
        known_data_folder(address)


def test_a_host_that_was_taken_for_dead_changes_nothing_that_is_read(
    new_database: str, tmp_path: Path
) -> None:
    first, second = hosts(new_database, tmp_path)
    id = jobs.add(first, ORDER).id
    old = jobs.claim(first, runner="a")
    assert old is not None
    assert jobs.begin(first, old)
    (first.attempt_folder(id, 1) / "result.json").write_text("old", "utf-8")
    assert [job.id for job in jobs.abandoned(second, lease=1.0)] == [id]
    jobs.recover(second, [old])
    new = jobs.claim(second, runner="b")
    assert new is not None
    # A second one that finds the same host dead does no harm.
    jobs.recover(second, [old])
    assert jobs.running(second, runner="b") == (new,)
    assert jobs.begin(second, new)
    (second.attempt_folder(id, 2) / "result.json").write_text("new", "utf-8")
    # Now the first host goes on.
    assert not jobs.begin(first, old)
    jobs.finish(first, old, JobState.FAILED, problem={"detail": "old"})
    assert jobs.get(first, id).state is JobState.RUNNING
    jobs.finish(second, new, JobState.SUCCEEDED)
    jobs.finish(first, old, JobState.FAILED, problem={"detail": "old"})
    found = jobs.get(first, id)
    assert (found.state, found.attempt, found.problem) == (JobState.SUCCEEDED, 2, None)
    assert (first.job_folder(id) / "result.json").read_text("utf-8") == "new"
    assert not first.attempt_folder(id, 1).exists()
    jobs.remove(first, id)
    assert list((tmp_path / "shared" / "jobs").iterdir()) == []


def test_the_results_that_count_are_shown_whoever_was_stopped_in_the_middle(
    new_database: str, tmp_path: Path
) -> None:
    first, second = hosts(new_database, tmp_path)
    id = jobs.add(first, ORDER).id
    old = jobs.claim(first, runner="a")
    assert old is not None
    jobs.recover(second, [old])
    new = jobs.claim(second, runner="b")
    assert new is not None
    assert jobs.begin(second, new)
    (second.attempt_folder(id, 2) / "result.json").write_text("new", "utf-8")
    # As when it was stopped for longer than its transaction may wait, and goes on now.
    show_attempt(first, id, 1)
    jobs.finish(second, new, JobState.SUCCEEDED)
    assert (first.job_folder(id) / "result.json").read_text("utf-8") == "new"


def test_no_job_is_queued_for_a_file_that_is_being_deleted(
    new_database: str, tmp_path: Path
) -> None:
    data_folder = open_data_folder(tmp_path, database=new_database)
    with FileUpload(data_folder, FileKind.LOG, "run.csv") as upload:
        upload.close()
        id = upload.keep(owner="anna").id
    order = JobRequest(kind=JobKind.VERIFICATION, request={"log_id": id}, owner="anna")
    said: list[str] = []

    def add() -> None:
        with pytest.raises(NotFound) as refused:
            jobs.add(data_folder, order)
        said.append(str(refused.value))

    thread = Thread(target=add)
    with data_folder.database.writing() as connection:
        connection.lock(f"file {id}")
        thread.start()
        until(lambda: waits(new_database))
        connection.execute("DELETE FROM files WHERE id = ?", (id,))
    thread.join(120.0)
    assert said == [f"there is no log '{id}'"]


def test_orders_that_came_before_the_run_are_found_by_it(
    new_database: str, tmp_path: Path
) -> None:
    data_folder, _ = hosts(new_database, tmp_path)
    id = jobs.add(data_folder, ORDER).id
    data_folder.job_folder(id).mkdir()
    (data_folder.job_folder(id) / "orders.jsonl").write_text("{}", "utf-8")
    job = jobs.claim(data_folder)
    assert job is not None
    assert jobs.begin(data_folder, job)
    for folder in (data_folder.attempt_folder(id, 1), data_folder.job_folder(id)):
        assert (folder / "orders.jsonl").read_text("utf-8") == "{}"
