"""A quick copy of a named tuple is what the standard library returns."""

from typing import NamedTuple

import pytest

from stepnc_model.tuples import quick_replace


class Plain(NamedTuple):
    """Some values."""

    time: float
    force: float = 2.0
    words: str = ""

    @property
    def double(self) -> float:
        """Twice the force."""
        return 2.0 * self.force


@quick_replace
class Quick(NamedTuple):
    """The same values."""

    time: float
    force: float = 2.0
    words: str = ""

    @property
    def double(self) -> float:
        """Twice the force."""
        return 2.0 * self.force


def test_a_copy_has_what_changes_and_keeps_the_rest() -> None:
    before = Quick(1.0, words="cut")
    after = before._replace(force=5.0, time=3.0)
    assert tuple(after) == tuple(Plain(1.0, words="cut")._replace(force=5.0, time=3.0))
    assert type(after) is Quick
    assert after.double == 10.0
    assert before == (1.0, 2.0, "cut")


def test_a_field_that_is_unknown_is_refused() -> None:
    with pytest.raises(ValueError, match="Quick has no field 'power'"):
        Quick(1.0)._replace(power=1.0)  # type: ignore[call-arg]
