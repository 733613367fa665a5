"""Machines and materials of the shop: names are looked up, not followed; bad files refused."""

import re
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from service.depot import library
from service.depot.folder import Depot
from service.depot.library import Shelf
from service.errors import Conflict, NotFound, Unreadable
from service.problem import problem_of
from simulator.errors import LibraryError, UnknownMachine
from simulator.library import DATA
from simulator.spec import Material
from stepnc_model.errors import StepNcError

MACHINE = (DATA / "machines" / "vmc15.toml").read_bytes()
MATERIAL = (DATA / "materials" / "c45.toml").read_bytes()

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
    assert library.text_of(depot, shelf, "our-own_1") == data
    assert [each.name for each in library.held(depot, shelf)] == [*before, "our-own_1"]
    library.remove(depot, shelf, "our-own_1")
    with pytest.raises(NotFound):
        library.one(depot, shelf, "our-own_1")
    with pytest.raises(NotFound):
        library.remove(depot, shelf, "our-own_1")


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
        library.text_of(depot, Shelf.MACHINES, name)
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
    with pytest.raises(NotFound):
        library.text_of(depot, shelf, name)


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
    assert library.text_of(depot, Shelf.MACHINES, "ours") == MACHINE


def test_a_machine_in_xml_takes_the_place_of_one_in_toml(depot: Depot) -> None:
    [sample] = [
        path
        for path in (Path(__file__).parents[2]).rglob("*.xml")
        if b"<Machine" in path.read_bytes()
    ][:1]
    library.put(depot, Shelf.MACHINES, "ours", MACHINE)
    library.put(depot, Shelf.MACHINES, "ours", sample.read_bytes())
    assert [path.name for path in (depot.root / "machines").iterdir()] == ["ours.xml"]
    library.put(depot, Shelf.MACHINES, "ours", MACHINE)
    assert [path.name for path in (depot.root / "machines").iterdir()] == ["ours.toml"]


def test_a_file_that_went_bad_on_the_disk_is_told_without_its_folder(depot: Depot) -> None:
    (depot.root / "machines" / "ours.toml").write_text("[spindle", encoding="utf-8")
    with pytest.raises(LibraryError) as refused:
        library.one(depot, Shelf.MACHINES, "ours")
    told = problem_of(refused.value, hidden=str(depot.root))
    assert str(depot.root) not in str(told)
    assert re.search(r"ours\.toml", told["detail"])
