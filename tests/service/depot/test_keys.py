"""Keys: told once, kept as a hash, of no use once revoked."""

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from service.depot import keys
from service.depot.folder import Depot
from service.depot.keys import Role
from service.errors import NotFound


def test_a_key_is_known_and_opens_what_its_roles_open(depot: Depot) -> None:
    word = keys.create(depot, name="Anna", roles=frozenset({Role.PLANNER}))
    key = keys.known(depot, word)
    assert key is not None
    assert (key.name, key.revoked) == ("Anna", None)
    assert key.opens(Role.VIEWER)
    assert key.opens(Role.PLANNER)
    assert not key.opens(Role.OPERATOR)


def test_every_key_may_look(depot: Depot) -> None:
    key = keys.known(depot, keys.create(depot, name="Bert", roles=frozenset()))
    assert key is not None
    assert [role for role in Role if key.opens(role)] == [Role.VIEWER]


def test_no_file_holds_the_secret(depot: Depot) -> None:
    word = keys.create(depot, name="Anna", roles=frozenset())
    secret = word.rsplit("_", 1)[1]
    for file in depot.root.iterdir():
        if file.is_file():
            held = file.read_bytes()
            assert secret.encode() not in held
            assert bytes.fromhex(secret) not in held


def test_a_revoked_key_is_of_no_use_and_stays_in_the_list(depot: Depot) -> None:
    word = keys.create(depot, name="Anna", roles=frozenset(Role))
    [key] = keys.listed(depot)
    keys.revoke(depot, key.id)
    assert keys.known(depot, word) is None
    [listed] = keys.listed(depot)
    assert listed.revoked is not None
    with pytest.raises(NotFound):
        keys.revoke(depot, key.id)
    with pytest.raises(NotFound):
        keys.revoke(depot, "nobody's")


def test_two_keys_of_one_name_are_two(depot: Depot) -> None:
    one = keys.create(depot, name="Anna", roles=frozenset())
    other = keys.create(depot, name="Anna", roles=frozenset({Role.OPERATOR}))
    assert one != other
    keys.revoke(depot, one.split("_")[1])
    assert keys.known(depot, one) is None
    assert keys.known(depot, other) is not None


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.data())
def test_a_word_that_differs_anywhere_is_no_key(depot: Depot, data: st.DataObject) -> None:
    word = data.draw(st.shared(st.builds(keys.create, st.just(depot), name=st.just("a"),
                                         roles=st.just(frozenset()))))  # fmt: skip
    at = data.draw(st.integers(0, len(word) - 1))
    letter = data.draw(st.characters())
    wrong = f"{word[:at]}{letter}{word[at + 1 :]}"
    assert (keys.known(depot, wrong) is None) == (wrong != word)


@pytest.mark.parametrize("word", ["", "stepnc", "stepnc__", "stepnc_x_y", "_" * 99, "é_ü_ß"])
def test_no_word_is_a_fault(depot: Depot, word: str) -> None:
    assert keys.known(depot, word) is None
