"""A table of cases in one test, which reports each case that fails.

``@every_case`` takes what ``@pytest.mark.parametrize`` takes, but is one test: for a table that
is looked up or refused line by line, where thousands of tests would cost more than their work.
"""

from collections.abc import Callable, Iterable, Sequence
from functools import wraps
from inspect import signature
from pathlib import Path
from reprlib import Repr
from typing import Any

import pytest

Test = Callable[..., None]

_SHOWN = Repr()
_SHOWN.maxstring = _SHOWN.maxother = 80


def every_case(names: str | Sequence[str], cases: Iterable[Any]) -> Callable[[Test], Test]:
    """Decorator that runs a test for every case and reports all that fail.

    A case has a ``tmp_path`` and a ``monkeypatch`` of its own, and a ``capsys`` that has been
    read; all other fixtures are shared by the cases.

    Parameters
    ----------
    names : str or sequence of str
        Arguments of the test that a case gives.
    cases : iterable
        A value per argument; the value itself where one argument is named by a string.
    """
    is_single = isinstance(names, str) and "," not in names
    keys = [key.strip() for key in names.split(",")] if isinstance(names, str) else list(names)
    table = tuple(cases)
    if not table:
        raise ValueError(f"no cases of {', '.join(keys)}")

    def decorate(test: Test) -> Test:
        taken = signature(test)

        @wraps(test)
        def wrapper(*bound: object, **fixtures: Any) -> None:
            faults: list[BaseException] = []
            for number, case in enumerate(table):
                values = [case] if is_single else list(case)
                try:
                    given = dict(zip(keys, values, strict=True))
                    with pytest.MonkeyPatch.context() as patch:
                        test(*bound, **given, **_fresh(fixtures, number, patch))
                except (Exception, pytest.fail.Exception) as fault:
                    fault.add_note(f"case {number}: {_SHOWN.repr(case)}")
                    faults.append(fault)
            if len(faults) == 1:
                raise faults[0]
            if faults:
                raise BaseExceptionGroup(f"{len(faults)} of {len(table)} cases fail", faults)

        kept = [value for key, value in taken.parameters.items() if key not in keys]
        if len(kept) + len(keys) != len(taken.parameters):
            raise TypeError(f"{test.__name__} does not take {', '.join(keys)}")
        wrapper.__signature__ = taken.replace(parameters=kept)  # type: ignore[attr-defined]
        return wrapper

    return decorate


def _fresh(fixtures: dict[str, Any], number: int, patch: pytest.MonkeyPatch) -> dict[str, Any]:
    """Fixtures of a case, without what the last case has left in them."""
    fresh = dict(fixtures)
    if "tmp_path" in fresh:
        folder: Path = fresh["tmp_path"] / str(number)
        folder.mkdir()
        fresh["tmp_path"] = folder
    if "capsys" in fresh:
        fresh["capsys"].readouterr()
    if "monkeypatch" in fresh:
        # Undoing the one of pytest would undo what other fixtures have set with it.
        fresh["monkeypatch"] = patch
    return fresh
