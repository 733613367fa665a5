"""Comparison of values of keys of a shop file: all combinations of them."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

from simulator.factory.measures import MeasureInterval
from stepnc_model.errors import StepNcError

MOST = 1_000
"""Most combinations."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SweptKey:
    """Key of a shop file with the values to compare."""

    key: str
    values: tuple[float | str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class SweptCase:
    """Combination of values with the figures of its runs."""

    changes: tuple[tuple[str, float | str], ...]
    measures: tuple[MeasureInterval, ...]


def swept_keys(texts: Sequence[str]) -> tuple[SweptKey, ...]:
    """Keys and values of texts such as ``product[1].batch=1,5,10``.

    Raises
    ------
    StepNcError
        When a text has another form, or there are too many combinations.
    """
    keys = []
    count = 1
    for text in texts:
        key, sign, values = text.partition("=")
        words = [word.strip() for word in values.split(",") if word.strip()]
        if not sign or not key.strip() or not words:
            raise StepNcError(f"sweep '{text}': expected KEY=VALUE,VALUE")
        keys.append(SweptKey(key=key.strip(), values=tuple(_value(word) for word in words)))
        count *= len(words)
    if count > MOST:
        raise StepNcError(f"sweep: {count} combinations: at most {MOST}")
    return tuple(keys)


def combinations(keys: Sequence[SweptKey]) -> list[dict[str, float | str]]:
    """All combinations of the values of keys."""
    names = [each.key for each in keys]
    return [
        dict(zip(names, values, strict=True))
        for values in product(*(each.values for each in keys))
    ]


def _value(word: str) -> float | str:
    try:
        return float(word)
    except ValueError:
        return word
