"""Machines and materials of the shop: names are looked up, not followed; bad files refused."""

import re
import shutil
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from errno import ENOSPC
from pathlib import Path
from subprocess import PIPE, Popen
from threading import Barrier
from typing import NoReturn

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from service.depot import library
from service.depot.folder import Depot
from service.depot.library import Shelf
from service.errors import (
    Conflict,
    NotFound,
    PreconditionFailed,
    StorageFull,
    Unavailable,
    Unreadable,
)
from service.problem import problem_of
from simulator.errors import LibraryError, UnknownMachine, UnknownMaterial
from simulator.library import DATA, load_machine
from simulator.spec import Machine, Material
from stepnc_model.errors import StepNcError

MACHINE = (DATA / "machines" / "vmc15.toml").read_bytes()
MATERIAL = (DATA / "materials" / "c45.toml").read_bytes()

XML = next(
    path.read_bytes()
    for path in sorted(Path(__file__).parents[2].rglob("*.xml"))
    if b"<Machine" in path.read_bytes()
)

PATHS = [
    "../vmc15", "/etc/passwd", "x.toml", "x.xml", "a/b", "a\\b", "x\0", "x\0.toml", ".", "..",
    "~", "x\n", "VMC", "é", "x" * 65, "-x", " x", "file:x", "%2e%2e",
]  # fmt: skip

BILLION = (
    b'<!DOCTYPE m [<!ENTITY a "ha">'
    + b"".join(
        b'<!ENTITY %c "%s">' % (each, (b"&%c;" % (each - 1)) * 10) for each in range(98, 107)
    )
    + b']><Machine id="&j;"/>'
)

BAD = {
    "empty table": b"a = 1",
    "no TOML": b"[[[[",
    "no text": b"\xff\xfe\x00",
    "NUL": b"title = 'a\0b'",
    "deep": b"a = " + b"[" * 50_000,
    "deep tables": b"[" + b"a." * 20_000 + b"a]",
    "huge number": b"title = " + b"9" * 10_000,
    "huge float": MACHINE.replace(b"max_speed_rpm = ", b"max_speed_rpm = 1e999 #", 1),
    "dotted key": b"a" + b".a" * 32_000 + b"=1",
    "integer beyond a float": MACHINE.replace(
        b"max_speed_rpm = ", b"max_speed_rpm = " + b"9" * 320 + b" #", 1
    ),
    "five megabytes": b"# " + b"x" * 5_000_000,
    "one long word": b"a" * 5_000_000,
    "no XML": b"<Machine",
    "another XML": b"<x/>",
    "billion laughs": BILLION,
    "external entity": b'<!DOCTYPE m [<!ENTITY e SYSTEM "file:///etc/passwd">]>'
    b"<Machine id='x'>&e;</Machine>",
    "external DTD": b'<!DOCTYPE m SYSTEM "file:///etc/passwd"><Machine id="x"/>',
    "deep XML": b"<a>" * 20_000,
}


@pytest.mark.parametrize("shelf", Shelf)
def test_a_file_is_kept_shown_and_deleted(depot: Depot, shelf: Shelf) -> None:
    data = MACHINE if shelf is Shelf.MACHINES else MATERIAL
    before = [each.name for each in library.held(depot, shelf)]
    kept = library.put(depot, shelf, "our-own_1", data)
    assert (kept.name, kept.is_own) == ("our-own_1", True)
    assert kept.entry == library.one(depot, shelf, "our-own_1").entry
    assert library.one(depot, shelf, "our-own_1").text == data
    assert [each.name for each in library.held(depot, shelf)] == [*before, "our-own_1"]
    library.remove(depot, shelf, "our-own_1")
    with pytest.raises(NotFound):
        library.one(depot, shelf, "our-own_1")
    with pytest.raises(NotFound):
        library.remove(depot, shelf, "our-own_1")


def test_a_machine_keeps_its_measured_modes(depot: Depot) -> None:
    mode = (
        b'\n[[mode]]\npart = "tool"\ntool = "MILL"\ndirection = "xy"\nfrequency_hz = 922\n'
        b'damping_ratio = 0.03\nstiffness_n_um = 12\nsource = "tap test"\n'
    )
    library.put(depot, Shelf.MACHINES, "tapped", MACHINE + mode)
    machine = library.one(depot, Shelf.MACHINES, "tapped").entry
    assert isinstance(machine, Machine)
    assert [each.natural_frequency for each in machine.modes] == [922.0]
    with pytest.raises(LibraryError, match=r"mode\[1\].damping_ratio"):
        library.put(depot, Shelf.MACHINES, "bad", MACHINE + mode.replace(b"0.03", b"3"))


@pytest.mark.parametrize("name", PATHS)
def test_a_name_that_could_be_a_path_is_never_one(depot: Depot, name: str) -> None:
    (depot.root / "x.toml").write_bytes(MACHINE)
    (depot.root.parent / "vmc15.toml").write_bytes(MACHINE)
    before = sorted(depot.root.parent.rglob("*"))
    with pytest.raises(Unreadable):
        library.put(depot, Shelf.MACHINES, name, MACHINE)
    with pytest.raises(NotFound):
        library.one(depot, Shelf.MACHINES, name)
    with pytest.raises(NotFound):
        library.remove(depot, Shelf.MACHINES, name)
    with pytest.raises(UnknownMachine):
        library.machine_word(depot, name)
    assert sorted(depot.root.parent.rglob("*")) == before


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.one_of(st.text(max_size=30), st.sampled_from(PATHS)))
def test_no_name_of_a_material_opens_a_file(depot: Depot, name: str) -> None:
    try:
        word = library.material_word(depot, name)
    except Unreadable:
        return
    assert word == name
    assert Path(word).suffix != ".toml"
    assert not set(word) & set("/\\")


def test_own_names_become_their_files_and_others_stay_names(depot: Depot) -> None:
    library.put(depot, Shelf.MACHINES, "ours", MACHINE)
    library.put(depot, Shelf.MATERIALS, "ours", MATERIAL)
    assert library.machine_word(depot, "ours") == str(depot.root / "machines" / "ours.toml")
    assert library.material_word(depot, "ours") == str(depot.root / "materials" / "ours.toml")
    for name in ("", "vmc15"):
        assert library.machine_word(depot, name) == name
    for name in ("", "c45", "1.0503", "AISI 1045"):
        assert library.material_word(depot, name) == name
    assert isinstance(library.material_of(depot, "1.0503"), Material)


@pytest.mark.parametrize("name", ["vmc15", "c45"])
def test_what_is_of_the_library_stays(depot: Depot, name: str) -> None:
    shelf = Shelf.MACHINES if name == "vmc15" else Shelf.MATERIALS
    with pytest.raises(Conflict, match="of the library"):
        library.put(depot, shelf, name, MACHINE)
    with pytest.raises(Conflict, match="of the library"):
        library.remove(depot, shelf, name)
    assert not library.one(depot, shelf, name).is_own


@pytest.mark.parametrize("shelf", Shelf)
@pytest.mark.parametrize("data", BAD.values(), ids=BAD)
def test_a_bad_file_is_refused_and_nothing_is_kept(
    depot: Depot, shelf: Shelf, data: bytes
) -> None:
    with pytest.raises(StepNcError) as refused:
        library.put(depot, shelf, "bad", data)
    assert list((depot.root / shelf.value).iterdir()) == []
    told = problem_of(refused.value, hidden=str(depot.root))
    assert told["status"] in {413, 422}
    assert "/tmp" not in str(told)
    assert "root:" not in str(told)
    assert len(str(told)) < 5000


def test_a_bad_file_leaves_the_good_one_before_it(depot: Depot) -> None:
    library.put(depot, Shelf.MACHINES, "ours", MACHINE)
    with pytest.raises(LibraryError):
        library.put(depot, Shelf.MACHINES, "ours", b"a = 1")
    assert library.one(depot, Shelf.MACHINES, "ours").text == MACHINE


def files(depot: Depot, shelf: Shelf = Shelf.MACHINES) -> list[str]:
    """Names of the files of the shop."""
    return sorted(each.name for each in (depot.root / shelf.value).iterdir() if each.suffix)


def shown(depot: Depot, shelf: Shelf = Shelf.MACHINES) -> dict[str, str]:
    """Names of the shop with their problems, each told once."""
    own = [each for each in library.held(depot, shelf) if each.is_own]
    found = {each.name: each.problem for each in own}
    assert len(found) == len(own)
    return found


def test_a_machine_in_xml_takes_the_place_of_one_in_toml(depot: Depot) -> None:
    library.put(depot, Shelf.MACHINES, "ours", MACHINE)
    library.put(depot, Shelf.MACHINES, "ours", XML)
    assert files(depot) == ["ours.xml"]
    library.put(depot, Shelf.MACHINES, "ours", MACHINE)
    assert files(depot) == ["ours.toml"]


def at_once(*works: Callable[[], object]) -> list[object]:
    """What works return, or raise, that begin together."""
    begin = Barrier(len(works))

    def work(one: Callable[[], object]) -> object:
        begin.wait(10.0)
        try:
            return one()
        except StepNcError as error:
            return error

    with ThreadPoolExecutor(len(works)) as pool:
        return list(pool.map(work, works))


def test_one_name_has_one_file_when_two_kinds_come_at_once(depot: Depot) -> None:
    def put(data: bytes) -> Callable[[], object]:
        return lambda: library.put(depot, Shelf.MACHINES, "ours", data)

    for _ in range(10):
        kept = at_once(put(MACHINE), put(XML), put(MACHINE), put(XML))
        assert all(isinstance(each, library.Held) for each in kept)
        assert len(files(depot)) == 1
        assert shown(depot) == {"ours": ""}
        library.remove(depot, Shelf.MACHINES, "ours")
        assert files(depot) == []


def test_two_files_of_one_name_are_one_machine_and_go_together(depot: Depot) -> None:
    library.put(depot, Shelf.MACHINES, "ours", MACHINE)
    (depot.root / "machines" / "ours.xml").write_bytes(XML)
    assert shown(depot) == {"ours": ""}
    assert library.one(depot, Shelf.MACHINES, "ours").text == MACHINE
    library.remove(depot, Shelf.MACHINES, "ours")
    assert files(depot) == []


@pytest.mark.parametrize("shelf", Shelf)
def test_of_those_who_saw_the_same_one_alone_changes_it(depot: Depot, shelf: Shelf) -> None:
    seen = MACHINE if shelf is Shelf.MACHINES else MATERIAL
    library.put(depot, shelf, "ours", seen)

    def put(number: int) -> Callable[[], object]:
        data = seen + f"\n# {number}".encode()
        return lambda: library.put(
            depot, shelf, "ours", data, condition=lambda text: text == seen
        )

    found = at_once(*(put(number) for number in range(6)))
    assert sum(isinstance(each, library.Held) for each in found) == 1
    assert sum(isinstance(each, PreconditionFailed) for each in found) == 5


CHANGER = """
import sys
from pathlib import Path
from service.depot import library
from service.depot.folder import open_depot
from service.depot.library import Shelf
from service.errors import PreconditionFailed
depot = open_depot(Path(sys.argv[1]))
print("ready", flush=True)
sys.stdin.read(1)
for number in range(10):
    seen = library.one(depot, Shelf.MATERIALS, "ours").text
    try:
        library.put(
            depot, Shelf.MATERIALS, "ours", seen + b"#", condition=lambda text: text == seen
        )
        print("changed")
    except PreconditionFailed:
        print("refused")
"""


def test_no_change_of_another_process_is_lost(depot: Depot) -> None:
    library.put(depot, Shelf.MATERIALS, "ours", MATERIAL + b"#")
    command = [sys.executable, "-c", CHANGER, str(depot.root)]
    changers = [Popen(command, stdin=PIPE, stdout=PIPE, text=True) for _ in range(2)]
    for changer in changers:
        assert changer.stdout is not None
        assert changer.stdout.readline() == "ready\n"
    for changer in changers:
        assert changer.stdin is not None
        changer.stdin.write("!")
        changer.stdin.flush()
    told = "".join(changer.communicate(timeout=60.0)[0] for changer in changers)
    assert all(changer.returncode == 0 for changer in changers)
    text = library.one(depot, Shelf.MATERIALS, "ours").text
    assert len(text) == len(MATERIAL) + 1 + told.count("changed")


def test_what_is_deleted_or_not_there_is_changed_by_nobody_who_saw_it(depot: Depot) -> None:
    for change in (
        lambda: library.put(depot, Shelf.MACHINES, "ours", MACHINE, condition=bool),
        lambda: library.remove(depot, Shelf.MACHINES, "ours", condition=bool),
    ):
        with pytest.raises(PreconditionFailed, match="is not there"):
            change()
    assert files(depot) == []


@pytest.mark.parametrize("shelf", Shelf)
def test_what_is_no_file_of_the_shop_harms_no_list(depot: Depot, shelf: Shelf) -> None:
    folder = depot.root / shelf.value
    library.put(depot, shelf, "ours", MACHINE if shelf is Shelf.MACHINES else MATERIAL)
    (folder / "readme.md").write_text("ours", encoding="utf-8")
    (folder / "notes").mkdir()
    (folder / "old.toml").mkdir()
    (folder / "vmc15.toml").write_bytes(MACHINE)
    (folder / "c45.toml").write_bytes(MATERIAL)
    (folder / "broken.toml").write_text("[[[[", encoding="utf-8")
    (folder / "gone.toml").symlink_to(folder / "none.toml")
    found = shown(depot, shelf)
    assert {"broken", "ours"} <= set(found) <= {"broken", "ours", "vmc15", "c45"}
    assert found["ours"] == ""
    assert "broken.toml" in found["broken"]
    assert str(depot.root) not in found["broken"]
    library.remove(depot, shelf, "broken")
    assert "broken" not in shown(depot, shelf)


def test_one_that_goes_while_the_list_is_read_is_left_out(
    depot: Depot, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("first", "second", "third"):
        library.put(depot, Shelf.MACHINES, name, MACHINE)

    def load(word: str) -> Machine:
        if Path(word).stem in {"first", "second"}:
            Path(word).unlink(missing_ok=True)
        return load_machine(word)

    monkeypatch.setitem(library._LOADERS, Shelf.MACHINES, load)
    assert shown(depot) == {"third": ""}


def test_one_that_is_replaced_while_it_is_read_is_read_again(
    depot: Depot, monkeypatch: pytest.MonkeyPatch
) -> None:
    library.put(depot, Shelf.MACHINES, "ours", MACHINE)

    def load(word: str) -> Machine:
        found = load_machine(word)
        if Path(word).suffix == ".toml":
            monkeypatch.undo()
            library.put(depot, Shelf.MACHINES, "ours", XML)
        return found

    monkeypatch.setitem(library._LOADERS, Shelf.MACHINES, load)
    found = library.one(depot, Shelf.MACHINES, "ours")
    assert found.text == XML
    assert found.entry == library.one(depot, Shelf.MACHINES, "ours").entry


@pytest.mark.parametrize(
    "place", ["tempfile._get_candidate_names", "service.depot.library.turn"]
)
def test_a_full_disk_is_told(depot: Depot, monkeypatch: pytest.MonkeyPatch, place: str) -> None:
    def full(*_: object) -> NoReturn:
        raise OSError(ENOSPC, "No space left on device")

    monkeypatch.setattr(place, full)
    with pytest.raises(StorageFull, match="No space left"):
        library.put(depot, Shelf.MACHINES, "ours", MACHINE)
    assert files(depot) == []


def test_a_folder_that_is_gone_is_told(depot: Depot) -> None:
    shutil.rmtree(depot.root / "machines")
    with pytest.raises(Unavailable):
        library.held(depot, Shelf.MACHINES)
    with pytest.raises(Unavailable):
        library.put(depot, Shelf.MACHINES, "ours", MACHINE)


@pytest.mark.parametrize(
    ("words", "kind"),
    [
        ({"machine": "none", "material": ""}, UnknownMachine),
        ({"machine": "", "material": "unobtainium"}, UnknownMaterial),
        ({"machine": "", "material": "../../etc/passwd"}, Unreadable),
        ({"machine": "broken", "material": ""}, LibraryError),
        ({"machine": "", "material": "broken"}, LibraryError),
    ],
)
def test_what_no_job_could_take_is_refused(
    depot: Depot, words: dict[str, str], kind: type[StepNcError]
) -> None:
    for shelf in Shelf:
        (depot.root / shelf.value / "broken.toml").write_text("[[[[", encoding="utf-8")
    with pytest.raises(kind):
        library.require(depot, **words)


def test_what_a_job_can_take_is_not_refused(depot: Depot) -> None:
    library.put(depot, Shelf.MACHINES, "ours", MACHINE)
    library.put(depot, Shelf.MATERIALS, "ours", MATERIAL)
    for machine, material in (("", ""), ("vmc15", "c45"), ("ours", "ours"), ("", "AISI 1045")):
        library.require(depot, machine=machine, material=material)


def test_a_file_that_went_bad_on_the_disk_is_told_without_its_folder(depot: Depot) -> None:
    (depot.root / "machines" / "ours.toml").write_text("[spindle", encoding="utf-8")
    with pytest.raises(LibraryError) as refused:
        library.one(depot, Shelf.MACHINES, "ours")
    told = problem_of(refused.value, hidden=str(depot.root))
    assert str(depot.root) not in str(told)
    assert re.search(r"ours\.toml", told["detail"])
