"""Seeded mutations of the instances of a Part 21 file, such as other writers leave."""

import re
from collections.abc import Callable
from random import Random

INSTANCE = re.compile(rb"^#(\d+)\s*=.*?;\s*$", re.MULTILINE | re.DOTALL)
REFERENCE = re.compile(rb"#\d+")
NUMBER = re.compile(rb"(?<=[(,])-?\d+\.\d*(?:E[+-]?\d+)?(?=[,)])")
TEXT = re.compile(rb"'[^']*'")
NUMBERS = (b"0.", b"-1.", b"1.E30", b"1.E-30", b"-0.", b"1.E308", b"3.")
TEXTS = (b"''", b"$", b"'rapid'", b"'toolpath'", b"'\\X2\\00E9\\X0\\'", b"'finishing'")


def mutated(data: bytes, rng: Random) -> bytes:
    """File with one to four mutations of its instances."""
    for _ in range(rng.randint(1, 4)):
        data = rng.choice(MUTATIONS)(data, rng)
    return data


def _chosen(data: bytes, rng: Random) -> re.Match[bytes]:
    """Instance of a file."""
    return rng.choice(list(INSTANCE.finditer(data)))


def _without(data: bytes, rng: Random) -> bytes:
    """File without an instance."""
    found = _chosen(data, rng)
    return data[: found.start()] + data[found.end() :]


def _twice(data: bytes, rng: Random) -> bytes:
    """File with an instance twice under one number."""
    found = _chosen(data, rng)
    return data[: found.end()] + b"\n" + found[0] + data[found.end() :]


def _exchanged(data: bytes, rng: Random, kind: re.Pattern[bytes], text: bytes) -> bytes:
    """File with another text in the place of one of a kind within an instance."""
    found = _chosen(data, rng)
    begin = data.index(b"=", found.start()) + 1
    places = list(kind.finditer(data, begin, found.end()))
    if not places:
        return data
    place = rng.choice(places)
    return data[: place.start()] + text + data[place.end() :]


def _null_reference(data: bytes, rng: Random) -> bytes:
    """File with a null in the place of a reference."""
    return _exchanged(data, rng, REFERENCE, b"$")


def _other_reference(data: bytes, rng: Random) -> bytes:
    """File with a reference to any other instance."""
    return _exchanged(data, rng, REFERENCE, b"#" + _chosen(data, rng)[1])


def _other_number(data: bytes, rng: Random) -> bytes:
    """File with another number."""
    return _exchanged(data, rng, NUMBER, rng.choice(NUMBERS))


def _other_text(data: bytes, rng: Random) -> bytes:
    """File with another text."""
    return _exchanged(data, rng, TEXT, rng.choice(TEXTS))


MUTATIONS: tuple[Callable[[bytes, Random], bytes], ...] = (
    _without,
    _twice,
    _null_reference,
    _other_reference,
    _other_number,
    _other_text,
)
