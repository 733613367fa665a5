"""Where a store lies, and that its password stays unsaid."""

from pathlib import Path

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from kbe.connection import parsed_place, require_openable
from kbe.errors import StoreUnavailable
from tests.every_case import every_case


@pytest.mark.parametrize(
    ("named", "file"),
    [
        ("kbe.db", "kbe.db"),
        ("sqlite:///kbe.db", "kbe.db"),
        ("sqlite:////srv/kbe.db", "/srv/kbe.db"),
        ("with ?#% signs.db", "with ?#% signs.db"),
        ("file:kbe.db", "./file:kbe.db"),
    ],
)
def test_file_is_what_was_named(named: str, file: str) -> None:
    place = parsed_place(named)
    assert place.file == file
    assert place.url.database == file


@pytest.mark.parametrize(
    ("named", "shown"),
    [
        ("postgresql://ann:secret@db.shop:5433/kbe", "postgresql://ann@db.shop:5433/kbe"),
        ("postgres://ann:secret@db/kbe", "postgresql://ann@db/kbe"),
        ("postgresql+psycopg://ann:s%40t@db/kbe", "postgresql://ann@db/kbe"),
        ("postgresql://ann@/kbe?host=%2Ftmp&password=secret", "postgresql://ann@/tmp/kbe"),
        ("postgresql://[::1]/kbe", "postgresql://::1/kbe"),
    ],
)
def test_server_is_shown_without_password(named: str, shown: str) -> None:
    place = parsed_place(named)
    assert place.shown == shown
    assert place.file == ""
    assert place.url.drivername == "postgresql+psycopg"


@every_case(
    "named",
    [
        "",
        ":memory:",
        "sqlite://",
        "sqlite:///:memory:",
        "a\0b",
        "mysql://ann:secret@db/kbe",
        "postgresql://ann:sec@ret@db/kbe",
        "postgresql://ann:1/secret@db/kbe",
        "postgresql://ann:1?secret@db/kbe",
        "postgresql://ann:secret#@db/kbe",
        "postgresql://ann:secret@db:port/kbe",
        "postgresql://[secret/kbe",
    ],
)
def test_what_is_no_place_is_refused_and_not_repeated(named: str) -> None:
    with pytest.raises(StoreUnavailable) as caught:
        parsed_place(named)
    assert "secret" not in str(caught.value)
    assert "name a file" in str(caught.value) or "%40 for @" in str(caught.value)


@given(password=st.text(st.characters(codec="ascii", exclude_categories=["C"]), min_size=4))
def test_password_is_never_repeated_even_when_it_is_not_escaped(password: str) -> None:
    assume(password not in "postgresql://ann@db.shop/kbe")
    try:
        said = parsed_place(f"postgresql://ann:{password}@db.shop/kbe").shown
    except StoreUnavailable as error:
        said = str(error).replace(
            "%40 for @, %2F for /, %3A for :, %23 for # and %3F for ?", ""
        )
        said = said.replace("postgresql://USER:PASSWORD@HOST:PORT/DATABASE", "")
        rest = "postgresql://…: is not a valid address; write , with  in the password"
        assume(password not in rest)
    assert password not in said


def test_folder_must_exist(tmp_path: Path) -> None:
    place = parsed_place(str(tmp_path / "missing" / "kbe.db"))
    with pytest.raises(StoreUnavailable, match="the folder does not exist; create it"):
        require_openable(place, is_new_allowed=True)


def test_folder_is_no_file(tmp_path: Path) -> None:
    with pytest.raises(StoreUnavailable, match="is not a file"):
        require_openable(parsed_place(str(tmp_path)), is_new_allowed=True)


def test_new_file_must_be_allowed(tmp_path: Path) -> None:
    place = parsed_place(str(tmp_path / "kbe.db"))
    require_openable(place, is_new_allowed=True)
    with pytest.raises(StoreUnavailable, match="check the name"):
        require_openable(place, is_new_allowed=False)
