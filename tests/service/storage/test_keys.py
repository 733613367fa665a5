"""Keys: told once, kept as a hash, of no use once revoked."""

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from service.errors import NotFound
from service.storage import keys
from service.storage.folder import DataFolder
from service.storage.keys import Role
from tests.every_case import every_case


def test_a_key_is_known_and_opens_what_its_roles_open(data_folder: DataFolder) -> None:
    word = keys.create(data_folder, name="Anna", roles=frozenset({Role.PLANNER}))
    key = keys.known(data_folder, word)
    assert key is not None
    assert (key.name, key.revoked) == ("Anna", None)
    assert key.opens(Role.VIEWER)
    assert key.opens(Role.PLANNER)
    assert not key.opens(Role.OPERATOR)


def test_every_key_may_look(data_folder: DataFolder) -> None:
    key = keys.known(data_folder, keys.create(data_folder, name="Bert", roles=frozenset()))
    assert key is not None
    assert [role for role in Role if key.opens(role)] == [Role.VIEWER]


def test_no_file_holds_the_secret(data_folder: DataFolder) -> None:
    word = keys.create(data_folder, name="Anna", roles=frozenset())
    secret = word.rsplit("_", 1)[1]
    for file in data_folder.root.iterdir():
        if file.is_file():
            held = file.read_bytes()
            assert secret.encode() not in held
            assert bytes.fromhex(secret) not in held


def test_a_revoked_key_is_of_no_use_and_stays_in_the_list(data_folder: DataFolder) -> None:
    word = keys.create(data_folder, name="Anna", roles=frozenset(Role))
    [key] = keys.listed(data_folder)
    keys.revoke(data_folder, key.id)
    assert keys.known(data_folder, word) is None
    [listed] = keys.listed(data_folder)
    assert listed.revoked is not None
    with pytest.raises(NotFound):
        keys.revoke(data_folder, key.id)
    with pytest.raises(NotFound):
        keys.revoke(data_folder, "nobody's")


def test_two_keys_of_one_name_are_two(data_folder: DataFolder) -> None:
    one = keys.create(data_folder, name="Anna", roles=frozenset())
    other = keys.create(data_folder, name="Anna", roles=frozenset({Role.OPERATOR}))
    assert one != other
    keys.revoke(data_folder, one.split("_")[1])
    assert keys.known(data_folder, one) is None
    assert keys.known(data_folder, other) is not None


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.data())
def test_a_word_that_differs_anywhere_is_no_key(
    data_folder: DataFolder, data: st.DataObject
) -> None:
    word = data.draw(st.shared(st.builds(keys.create, st.just(data_folder), name=st.just("a"),
                                         roles=st.just(frozenset()))))  # fmt: skip
    at = data.draw(st.integers(0, len(word) - 1))
    letter = data.draw(st.characters())
    wrong = f"{word[:at]}{letter}{word[at + 1 :]}"
    assert (keys.known(data_folder, wrong) is None) == (wrong != word)


@every_case("word", ["", "stepnc", "stepnc__", "stepnc_x_y", "_" * 99, "é_ü_ß"])
def test_no_word_is_a_fault(data_folder: DataFolder, word: str) -> None:
    assert keys.known(data_folder, word) is None
