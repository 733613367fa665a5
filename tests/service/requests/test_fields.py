"""Fields of requests give options, help and bounds."""

import argparse
from dataclasses import dataclass
from enum import StrEnum
from typing import Annotated

import pytest
from annotated_types import Interval, MaxLen

from kbe.evaluation import RowFilter
from service.requests.fields import (
    About,
    Request,
    add_options,
    fields_of,
    from_options,
    member_of,
    require_bounds,
)
from stepnc_model.errors import StepNcError
from tests.every_case import every_case


class Colour(StrEnum):
    """Two of them."""

    RED = "red"
    BLUE = "Blue"


@dataclass(frozen=True, slots=True, kw_only=True)
class Order(Request):
    """A request with a field of each kind."""

    colour: Annotated[Colour, About("of it", flag="--colour")] = Colour.RED
    colours: Annotated[tuple[Colour, ...], About("some", flag="--colours")] = (Colour.RED,)
    names: Annotated[tuple[str, ...], MaxLen(2), About("repeatable", flag="--name")] = ()
    size_mm: Annotated[
        float | None,
        Interval(gt=0.0, le=10.0),
        About("100 % of it", unit="mm", name="size", flag="--size", metavar="MM"),
    ] = None
    share: Annotated[float, Interval(ge=0.0, lt=1.0), About("of it", flag="--share")] = 0.25
    is_big: Annotated[bool, About("or small", flag="--big")] = False
    steps: Annotated[
        tuple[Annotated[int, Interval(ge=1, le=9)], ...], About("some", is_word=True)
    ] = ()
    hidden: Annotated[int, About("has no option")] = 3
    plain: int = 4


def typed(*words: str) -> Order:
    parser = argparse.ArgumentParser()
    add_options(parser, Order)
    order = from_options(Order, parser.parse_args(words))
    require_bounds(order)
    return order


def test_nothing_typed_is_the_usual() -> None:
    assert typed() == Order()


def test_words_become_values() -> None:
    asked = typed(
        "--colour", "BLUE", "--colours", "red, blue", "--name", "a,b", "--name", "c",
        "--size", "2.5", "--big", "2", "3",
    )  # fmt: skip
    assert asked == Order(
        colour=Colour.BLUE, colours=(Colour.RED, Colour.BLUE), names=("a,b", "c"),
        size_mm=2.5, is_big=True, steps=(2, 3),
    )  # fmt: skip


@every_case(
    ("words", "message"),
    [
        (("--size", "0"), "size 0 mm: it must be above 0 to 10 mm"),
        (("--size", "nan"), "size nan mm: it must be above 0 to 10 mm"),
        (("--size", "11"), "size 11 mm: it must be above 0 to 10 mm"),
        (("--share", "1"), "share 1: it must be at least 0 and below 1"),
        (("--share", "-0.1"), "share -0.1: it must be at least 0 and below 1"),
        (("1", "10"), "steps 10: it must be 1 to 9"),
        (("--colour", "green"), "unknown colour 'green'; known: red, Blue"),
        (
            ("--name", "a", "--name", "b", "--name", "c"),
            "names of 3: it must be at most 2 long",
        ),
    ],
)
def test_what_is_beyond_its_bounds_is_told_with_unit(
    words: tuple[str, ...], message: str
) -> None:
    with pytest.raises(StepNcError) as caught:
        typed(*words)
    assert str(caught.value) == message


def test_help_has_texts_and_defaults() -> None:
    parser = argparse.ArgumentParser()
    add_options(parser, Order, usual={"share": 0.5})
    text = " ".join(parser.format_help().split())
    assert "--colour COLOUR of it (default: red)" in text
    assert "--size MM 100 % of it" in text
    assert "of it (default: 0.5)" in text
    assert "hidden" not in text


def test_only_what_is_documented_is_a_field() -> None:
    names = [field.name for field in fields_of(Order)]
    assert "hidden" in names
    assert "plain" not in names


def test_a_request_made_in_python_is_checked_too() -> None:
    with pytest.raises(StepNcError, match="size 20 mm"):
        require_bounds(Order(size_mm=20.0))
    require_bounds(Order(size_mm=10.0))


def test_members_are_found_whatever_their_case_and_with_hyphens() -> None:
    assert member_of(Colour, "bLUE", "colour") is Colour.BLUE
    assert member_of(RowFilter, "With-Remarks", "only") is RowFilter.WITH_REMARKS
    assert member_of(RowFilter, "with remarks", "only") is RowFilter.WITH_REMARKS
