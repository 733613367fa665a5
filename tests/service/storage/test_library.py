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

from service.errors import (
    Conflict,
    NotFound,
    PreconditionFailed,
    StorageFull,
    Unavailable,
    Unreadable,
)
from service.storage import library
from service.storage.folder import DataFolder
from service.storage.library import LibrarySection
from service.web.problem import problem_of
from simulator.errors import LibraryError, UnknownMachine, UnknownMaterial
from simulator.library import DATA, load_machine
from simulator.spec import Machine, WorkMaterial
from stepnc_model.errors import StepNcError
from tests.every_case import every_case

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


@pytest.mark.parametrize("section", LibrarySection)
def test_a_file_is_kept_shown_and_deleted(
    data_folder: DataFolder, section: LibrarySection
) -> None:
    data = MACHINE if section is LibrarySection.MACHINES else MATERIAL
    before = [each.name for each in library.entries_of(data_folder, section)]
    kept = library.put(data_folder, section, "our-own_1", data)
    assert (kept.name, kept.is_own) == ("our-own_1", True)
    assert kept.entry == library.one(data_folder, section, "our-own_1").entry
    assert library.one(data_folder, section, "our-own_1").text == data
    assert [each.name for each in library.entries_of(data_folder, section)] == [
        *before,
        "our-own_1",
    ]
    library.remove(data_folder, section, "our-own_1")
    with pytest.raises(NotFound):
        library.one(data_folder, section, "our-own_1")
    with pytest.raises(NotFound):
        library.remove(data_folder, section, "our-own_1")


def test_a_machine_keeps_its_measured_modes(data_folder: DataFolder) -> None:
    mode = (
        b'\n[[mode]]\npart = "tool"\ntool = "MILL"\ndirection = "xy"\nfrequency_hz = 922\n'
        b'damping_ratio = 0.03\nstiffness_n_um = 12\nsource = "tap test"\n'
    )
    library.put(data_folder, LibrarySection.MACHINES, "tapped", MACHINE + mode)
    machine = library.one(data_folder, LibrarySection.MACHINES, "tapped").entry
    assert isinstance(machine, Machine)
    assert [each.natural_frequency for each in machine.modes] == [922.0]
    with pytest.raises(LibraryError, match=r"mode\[1\].damping_ratio"):
        library.put(
            data_folder, LibrarySection.MACHINES, "bad", MACHINE + mode.replace(b"0.03", b"3")
        )


@every_case("name", PATHS)
def test_a_name_that_could_be_a_path_is_never_one(data_folder: DataFolder, name: str) -> None:
    (data_folder.root / "x.toml").write_bytes(MACHINE)
    (data_folder.root.parent / "vmc15.toml").write_bytes(MACHINE)
    before = sorted(data_folder.root.parent.rglob("*"))
    with pytest.raises(Unreadable):
        library.put(data_folder, LibrarySection.MACHINES, name, MACHINE)
    with pytest.raises(NotFound):
        library.one(data_folder, LibrarySection.MACHINES, name)
    with pytest.raises(NotFound):
        library.remove(data_folder, LibrarySection.MACHINES, name)
    with pytest.raises(UnknownMachine):
        library.machine_word(data_folder, name)
    assert sorted(data_folder.root.parent.rglob("*")) == before


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.one_of(st.text(max_size=30), st.sampled_from(PATHS)))
def test_no_name_of_a_material_opens_a_file(data_folder: DataFolder, name: str) -> None:
    try:
        word = library.material_word(data_folder, name)
    except Unreadable:
        return
    assert word == name
    assert Path(word).suffix != ".toml"
    assert not set(word) & set("/\\")


def test_own_names_become_their_files_and_others_stay_names(data_folder: DataFolder) -> None:
    library.put(data_folder, LibrarySection.MACHINES, "ours", MACHINE)
    library.put(data_folder, LibrarySection.MATERIALS, "ours", MATERIAL)
    assert library.machine_word(data_folder, "ours") == str(
        data_folder.root / "machines" / "ours.toml"
    )
    assert library.material_word(data_folder, "ours") == str(
        data_folder.root / "materials" / "ours.toml"
    )
    for name in ("", "vmc15"):
        assert library.machine_word(data_folder, name) == name
    for name in ("", "c45", "1.0503", "AISI 1045"):
        assert library.material_word(data_folder, name) == name
    assert isinstance(library.material_of(data_folder, "1.0503"), WorkMaterial)


@pytest.mark.parametrize("name", ["vmc15", "c45"])
def test_what_is_of_the_library_stays(data_folder: DataFolder, name: str) -> None:
    section = LibrarySection.MACHINES if name == "vmc15" else LibrarySection.MATERIALS
    with pytest.raises(Conflict, match="is built in"):
        library.put(data_folder, section, name, MACHINE)
    with pytest.raises(Conflict, match="is built in"):
        library.remove(data_folder, section, name)
    assert not library.one(data_folder, section, name).is_own


@every_case("section", LibrarySection)
@every_case("data", BAD.values())
def test_a_bad_file_is_refused_and_nothing_is_kept(
    data_folder: DataFolder, section: LibrarySection, data: bytes
) -> None:
    with pytest.raises(StepNcError) as refused:
        library.put(data_folder, section, "bad", data)
    assert list((data_folder.root / section.value).iterdir()) == []
    told = problem_of(refused.value, hidden=str(data_folder.root))
    assert told["status"] in {413, 422}
    assert "/tmp" not in str(told)
    assert "root:" not in str(told)
    assert len(str(told)) < 5000


def test_a_bad_file_leaves_the_good_one_before_it(data_folder: DataFolder) -> None:
    library.put(data_folder, LibrarySection.MACHINES, "ours", MACHINE)
    with pytest.raises(LibraryError):
        library.put(data_folder, LibrarySection.MACHINES, "ours", b"a = 1")
    assert library.one(data_folder, LibrarySection.MACHINES, "ours").text == MACHINE


def files(
    data_folder: DataFolder, section: LibrarySection = LibrarySection.MACHINES
) -> list[str]:
    """Names of the files of the shop."""
    return sorted(
        each.name for each in (data_folder.root / section.value).iterdir() if each.suffix
    )


def shown(
    data_folder: DataFolder, section: LibrarySection = LibrarySection.MACHINES
) -> dict[str, str]:
    """Names of the shop with their problems, each told once."""
    own = [each for each in library.entries_of(data_folder, section) if each.is_own]
    found = {each.name: each.problem for each in own}
    assert len(found) == len(own)
    return found


def test_a_machine_in_xml_takes_the_place_of_one_in_toml(data_folder: DataFolder) -> None:
    library.put(data_folder, LibrarySection.MACHINES, "ours", MACHINE)
    library.put(data_folder, LibrarySection.MACHINES, "ours", XML)
    assert files(data_folder) == ["ours.xml"]
    library.put(data_folder, LibrarySection.MACHINES, "ours", MACHINE)
    assert files(data_folder) == ["ours.toml"]


def at_once(*works: Callable[[], object]) -> list[object]:
    """What works return, or raise, that begin together."""
    begin = Barrier(len(works))

    def work(one: Callable[[], object]) -> object:
        begin.wait(120.0)
        try:
            return one()
        except StepNcError as error:
            return error

    with ThreadPoolExecutor(len(works)) as pool:
        return list(pool.map(work, works))


def test_one_name_has_one_file_when_two_kinds_come_at_once(data_folder: DataFolder) -> None:
    def put(data: bytes) -> Callable[[], object]:
        return lambda: library.put(data_folder, LibrarySection.MACHINES, "ours", data)

    for _ in range(10):
        kept = at_once(put(MACHINE), put(XML), put(MACHINE), put(XML))
        assert all(isinstance(each, library.LibraryEntry) for each in kept)
        assert len(files(data_folder)) == 1
        assert shown(data_folder) == {"ours": ""}
        library.remove(data_folder, LibrarySection.MACHINES, "ours")
        assert files(data_folder) == []


def test_two_files_of_one_name_are_one_machine_and_go_together(data_folder: DataFolder) -> None:
    library.put(data_folder, LibrarySection.MACHINES, "ours", MACHINE)
    (data_folder.root / "machines" / "ours.xml").write_bytes(XML)
    assert shown(data_folder) == {"ours": ""}
    assert library.one(data_folder, LibrarySection.MACHINES, "ours").text == MACHINE
    library.remove(data_folder, LibrarySection.MACHINES, "ours")
    assert files(data_folder) == []


@pytest.mark.parametrize("section", LibrarySection)
def test_of_those_who_saw_the_same_one_alone_changes_it(
    data_folder: DataFolder, section: LibrarySection
) -> None:
    seen = MACHINE if section is LibrarySection.MACHINES else MATERIAL
    library.put(data_folder, section, "ours", seen)

    def put(number: int) -> Callable[[], object]:
        data = seen + f"\n# {number}".encode()
        return lambda: library.put(
            data_folder, section, "ours", data, condition=lambda text: text == seen
        )

    found = at_once(*(put(number) for number in range(6)))
    assert sum(isinstance(each, library.LibraryEntry) for each in found) == 1
    assert sum(isinstance(each, PreconditionFailed) for each in found) == 5


CHANGER = """
import sys
from pathlib import Path
from service.storage import library
from service.storage.folder import open_data_folder
from service.storage.library import LibrarySection
from service.errors import PreconditionFailed
data_folder = open_data_folder(Path(sys.argv[1]), database=sys.argv[2])
print("ready", flush=True)
sys.stdin.read(1)
for number in range(10):
    seen = library.one(data_folder, LibrarySection.MATERIALS, "ours").text
    try:
        library.put(
            data_folder,
            LibrarySection.MATERIALS,
            "ours",
            seen + b"#",
            condition=lambda text: text == seen,
        )
        print("changed")
    except PreconditionFailed:
        print("refused")
"""


def test_no_change_of_another_process_is_lost(data_folder: DataFolder) -> None:
    library.put(data_folder, LibrarySection.MATERIALS, "ours", MATERIAL + b"#")
    address = data_folder.address
    command = [sys.executable, "-c", CHANGER, address.root, address.database]
    changers = [Popen(command, stdin=PIPE, stdout=PIPE, text=True) for _ in range(2)]
    for changer in changers:
        assert changer.stdout is not None
        assert changer.stdout.readline() == "ready\n"
    for changer in changers:
        assert changer.stdin is not None
        changer.stdin.write("!")
        changer.stdin.flush()
    told = "".join(changer.communicate(timeout=120.0)[0] for changer in changers)
    assert all(changer.returncode == 0 for changer in changers)
    text = library.one(data_folder, LibrarySection.MATERIALS, "ours").text
    assert len(text) == len(MATERIAL) + 1 + told.count("changed")


def test_what_is_deleted_or_not_there_is_changed_by_nobody_who_saw_it(
    data_folder: DataFolder,
) -> None:
    for change in (
        lambda: library.put(
            data_folder, LibrarySection.MACHINES, "ours", MACHINE, condition=bool
        ),
        lambda: library.remove(data_folder, LibrarySection.MACHINES, "ours", condition=bool),
    ):
        with pytest.raises(PreconditionFailed, match="does not exist"):
            change()
    assert files(data_folder) == []


@pytest.mark.parametrize("section", LibrarySection)
def test_what_is_no_file_of_the_shop_harms_no_list(
    data_folder: DataFolder, section: LibrarySection
) -> None:
    folder = data_folder.root / section.value
    library.put(
        data_folder,
        section,
        "ours",
        MACHINE if section is LibrarySection.MACHINES else MATERIAL,
    )
    (folder / "readme.md").write_text("ours", encoding="utf-8")
    (folder / "notes").mkdir()
    (folder / "old.toml").mkdir()
    (folder / "vmc15.toml").write_bytes(MACHINE)
    (folder / "c45.toml").write_bytes(MATERIAL)
    (folder / "broken.toml").write_text("[[[[", encoding="utf-8")
    (folder / "gone.toml").symlink_to(folder / "none.toml")
    found = shown(data_folder, section)
    assert {"broken", "ours"} <= set(found) <= {"broken", "ours", "vmc15", "c45"}
    assert found["ours"] == ""
    assert "broken.toml" in found["broken"]
    assert str(data_folder.root) not in found["broken"]
    library.remove(data_folder, section, "broken")
    assert "broken" not in shown(data_folder, section)


def test_one_that_goes_while_the_list_is_read_is_left_out(
    data_folder: DataFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("first", "second", "third"):
        library.put(data_folder, LibrarySection.MACHINES, name, MACHINE)

    def load(word: str) -> Machine:
        if Path(word).stem in {"first", "second"}:
            Path(word).unlink(missing_ok=True)
        return load_machine(word)

    monkeypatch.setitem(library._LOADERS, LibrarySection.MACHINES, load)
    assert shown(data_folder) == {"third": ""}


def test_one_that_is_replaced_while_it_is_read_is_read_again(
    data_folder: DataFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    library.put(data_folder, LibrarySection.MACHINES, "ours", MACHINE)

    def load(word: str) -> Machine:
        found = load_machine(word)
        if Path(word).suffix == ".toml":
            monkeypatch.undo()
            library.put(data_folder, LibrarySection.MACHINES, "ours", XML)
        return found

    monkeypatch.setitem(library._LOADERS, LibrarySection.MACHINES, load)
    found = library.one(data_folder, LibrarySection.MACHINES, "ours")
    assert found.text == XML
    assert found.entry == library.one(data_folder, LibrarySection.MACHINES, "ours").entry


@pytest.mark.parametrize(
    "place", ["tempfile._get_candidate_names", "service.storage.library.locked"]
)
def test_a_full_disk_is_told(
    data_folder: DataFolder, monkeypatch: pytest.MonkeyPatch, place: str
) -> None:
    def full(*_: object) -> NoReturn:
        raise OSError(ENOSPC, "No space left on device")

    monkeypatch.setattr(place, full)
    with pytest.raises(StorageFull, match="No space left"):
        library.put(data_folder, LibrarySection.MACHINES, "ours", MACHINE)
    assert files(data_folder) == []


def test_a_folder_that_is_gone_is_told(data_folder: DataFolder) -> None:
    shutil.rmtree(data_folder.root / "machines")
    with pytest.raises(Unavailable):
        library.entries_of(data_folder, LibrarySection.MACHINES)
    with pytest.raises(Unavailable):
        library.put(data_folder, LibrarySection.MACHINES, "ours", MACHINE)


@every_case(
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
    data_folder: DataFolder, words: dict[str, str], kind: type[StepNcError]
) -> None:
    for section in LibrarySection:
        (data_folder.root / section.value / "broken.toml").write_text("[[[[", encoding="utf-8")
    with pytest.raises(kind):
        library.require(data_folder, **words)


def test_what_a_job_can_take_is_not_refused(data_folder: DataFolder) -> None:
    library.put(data_folder, LibrarySection.MACHINES, "ours", MACHINE)
    library.put(data_folder, LibrarySection.MATERIALS, "ours", MATERIAL)
    for machine, material in (("", ""), ("vmc15", "c45"), ("ours", "ours"), ("", "AISI 1045")):
        library.require(data_folder, machine=machine, material=material)


def test_a_file_that_went_bad_on_the_disk_is_told_without_its_folder(
    data_folder: DataFolder,
) -> None:
    (data_folder.root / "machines" / "ours.toml").write_text("[spindle", encoding="utf-8")
    with pytest.raises(LibraryError) as refused:
        library.one(data_folder, LibrarySection.MACHINES, "ours")
    told = problem_of(refused.value, hidden=str(data_folder.root))
    assert str(data_folder.root) not in str(told)
    assert re.search(r"ours\.toml", told["detail"])
