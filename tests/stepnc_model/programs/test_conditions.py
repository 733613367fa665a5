"""Conditions are evaluated with the values that the file states at their place."""

import pytest

from tests.stepnc_model.programs.test_program import (
    COMMON,
    PROJECT,
    ids,
    only_fault,
    plan,
    program_of,
    step,
)

CONSTANTS = (
    "#80=NC_VARIABLE('N',2.);",
    "#81=NC_CONSTANT('TWO',2.);",
    "#82=NC_CONSTANT('THREE',3.);",
)


def walked(condition: str, *more: str, first: tuple[int, ...] = ()) -> list[int]:
    program = program_of(
        PROJECT,
        plan(2, *first, 5),
        "#5=IF_STATEMENT('S',#90,#10,#11);",
        f"#90={condition};",
        *more,
        *map(step, (10, 11)),
        *CONSTANTS,
        *COMMON,
    )
    assert not program.faults
    return [number for number in ids(program) if number in {10, 11}]


@pytest.mark.parametrize(
    ("keyword", "with_two", "with_three"),
    [
        ("EQUAL", True, False),
        ("NOT_EQUAL", False, True),
        ("GREATER", False, False),
        ("GREATER_EQUAL", True, False),
        ("LESS", False, True),
        ("LESS_EQUAL", True, True),
    ],
)
def test_two_is_compared(keyword: str, with_two: bool, with_three: bool) -> None:
    for constant, is_true in ((81, with_two), (82, with_three)):
        assert walked(f"COMPARISON_{keyword}(#80,#{constant})") == [10 if is_true else 11]


TRUE, FALSE = "#91=COMPARISON_EQUAL(#80,#81);", "#92=COMPARISON_EQUAL(#80,#82);"


@pytest.mark.parametrize(
    ("expression", "is_true"),
    [
        ("NOT_EXPRESSION(#92)", True),
        ("NOT_EXPRESSION(#91)", False),
        ("AND_EXPRESSION((#91,#91))", True),
        ("AND_EXPRESSION((#91,#92))", False),
        ("OR_EXPRESSION((#92,#91))", True),
        ("OR_EXPRESSION((#92,#92))", False),
        ("XOR_EXPRESSION(#91,#92)", True),
        ("XOR_EXPRESSION(#91,#91)", False),
    ],
)
def test_conditions_are_joined(expression: str, is_true: bool) -> None:
    assert walked(expression, TRUE, FALSE) == [10 if is_true else 11]


def test_an_assignment_counts_from_its_place_on() -> None:
    more = ("#6=ASSIGNMENT('A',#80,#82);",)
    assert walked("COMPARISON_EQUAL(#80,#82)", *more) == [11]
    assert walked("COMPARISON_EQUAL(#80,#82)", *more, first=(6,)) == [10]


def test_a_shared_condition_is_evaluated_once_however_deep_it_lies() -> None:
    # Two references to the next one each: 2 ** 60 evaluations one by one.
    chain = [f"#{n}=AND_EXPRESSION((#{n + 1},#{n + 1}));" for n in range(91, 151)]
    assert walked("NOT_EXPRESSION(#91)", *chain, "#151=COMPARISON_EQUAL(#80,#81);") == [11]


@pytest.mark.parametrize(
    ("condition", "reason"),
    [
        (
            "COMPARISON_EQUAL(#70,#72)",
            'only the control knows; set it with --set "#70.initial_',
        ),
        ("NOT_EXPRESSION(#90)", "nested deeper than 100"),
        ("COMPARISON_EQUAL(#66,#72)", "#66 DRILLING: is not a variable"),
        ("COMPARISON_EQUAL($,#72)", "is missing"),
        ("NOT_EXPRESSION(#66)", "not a condition"),
        ("NOT_EXPRESSION($)", "missing"),
        ("NOT_EXPRESSION(#999)", "#999"),
    ],
)
def test_a_condition_that_is_not_stated_leaves_open_what_runs(
    condition: str, reason: str
) -> None:
    program = program_of(
        PROJECT,
        plan(2, 5),
        "#5=IF_STATEMENT('S',#90,#10,#11);",
        f"#90={condition};",
        *map(step, (10, 11)),
        *COMMON,
    )
    assert reason in str(only_fault(program))
    assert ids(program) == [2, 5, 10, 11]
    assert not program.workingsteps
