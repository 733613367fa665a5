"""Values of one attribute: what is tolerated, and what is said about it."""

from math import inf, nan

import pytest

from stepnc_model.entities.conversion import AttributeSlot, give, take, take_missing
from stepnc_model.entities.entity import Entity
from stepnc_model.entities.enums import Logical, SpeedName, ToolReferencePoint
from stepnc_model.errors import Severity
from stepnc_model.part21.values import (
    DERIVED,
    Binary,
    Enumeration,
    Real,
    Ref,
    Typed,
    Value,
)
from tests.every_case import every_case

NUMBER = AttributeSlot(plain=(float,))
COUNT = AttributeSlot(plain=(int,))
LABEL = AttributeSlot(plain=(str,))
TRUTH = AttributeSlot(plain=(bool,))
NAME = AttributeSlot(enumeration=ToolReferencePoint)
REFERENCE = AttributeSlot(references=(Entity,))
NUMBERS = AttributeSlot(items=NUMBER)
REFERENCES = AttributeSlot(items=REFERENCE)
FEED = AttributeSlot(plain=(Typed, float), is_optional=True)
SPEED = AttributeSlot(plain=(Typed, float), enumeration=SpeedName, references=(Entity,))


@every_case(
    ("slot", "value", "expected"),
    [
        (NUMBER, Real(0.04), 0.04),
        (NUMBER, 12, 12.0),
        (NUMBER, Typed("LENGTH_MEASURE", Real(3.0)), 3.0),
        (NUMBER, Typed("LENGTH_MEASURE", 3), 3.0),
        (NUMBER, DERIVED, None),
        (COUNT, 4, 4),
        (LABEL, "MILL 18MM", "MILL 18MM"),
        (TRUTH, Enumeration("T"), True),
        (TRUTH, Enumeration("F"), False),
        (NAME, Enumeration("TCP"), ToolReferencePoint.TCP),
        (NAME, Enumeration("ccp"), ToolReferencePoint.CCP),
        (AttributeSlot(enumeration=Logical), Enumeration("U"), Logical.UNKNOWN),
        (REFERENCE, Ref(7), Ref(7)),
        (NUMBERS, (), ()),
        (NUMBERS, (Real(1.0), 2), (1.0, 2.0)),
        (REFERENCES, (Ref(1), Ref(2)), (Ref(1), Ref(2))),
        (AttributeSlot(plain=(str,), is_optional=True), None, None),
        (FEED, None, None),
        (FEED, Real(0.1), 0.1),
        (FEED, Typed("FEED_PER_REV_TYPE", Real(0.1)), Typed("FEED_PER_REV_TYPE", Real(0.1))),
        (SPEED, Typed("SPEED_NAME", Enumeration("RAPID")), SpeedName.RAPID),
        (SPEED, Enumeration("RAPID"), SpeedName.RAPID),
        (SPEED, Ref(3), Ref(3)),
    ],
)
def test_value_that_fits_is_taken_without_a_word(
    slot: AttributeSlot, value: Value, expected: object
) -> None:
    assert take(slot, value) == (expected, None)


@every_case(
    ("slot", "value", "expected", "severity", "words"),
    [
        (NUMBERS, None, (), Severity.NOTE, "$"),
        (LABEL, None, "", Severity.NOTE, "$"),
        (NUMBER, None, None, Severity.WARNING, "$"),
        (NAME, None, None, Severity.WARNING, "one of"),
        (REFERENCE, None, None, Severity.WARNING, "$"),
        (COUNT, Real(4.0), 4, Severity.NOTE, "a real"),
        (COUNT, Real(4.5), None, Severity.ERROR, "4.5"),
        (COUNT, Real(inf), None, Severity.ERROR, "finite"),
        (NUMBER, Real(inf), None, Severity.ERROR, "finite"),
        (NUMBER, Real(nan), None, Severity.ERROR, "finite"),
        (NUMBER, 10**400, None, Severity.ERROR, "too large"),
        (FEED, Typed("FEED_PER_REV_TYPE", Real(inf)), None, Severity.ERROR, "finite"),
        (NUMBER, "0.04", None, Severity.ERROR, "'0.04'"),
        (NUMBER, Ref(4), None, Severity.ERROR, "#4"),
        (NUMBER, Enumeration("T"), None, Severity.ERROR, ".T."),
        (NUMBER, (Real(1.0),), None, Severity.ERROR, "a list"),
        (LABEL, Real(1.0), "", Severity.ERROR, "1.0"),
        (LABEL, Binary("0A"), "", Severity.ERROR, "'0A'"),
        (TRUTH, Enumeration("U"), None, Severity.WARNING, "truth value"),
        (NAME, Enumeration("TIP"), None, Severity.WARNING, ".TIP."),
        (NAME, "TCP", None, Severity.ERROR, "'TCP'"),
        (REFERENCE, Real(7.0), None, Severity.ERROR, "7.0"),
        (NUMBERS, Real(1.0), (1.0,), Severity.WARNING, "brackets"),
        (REFERENCES, Ref(1), (Ref(1),), Severity.WARNING, "brackets"),
        (NUMBERS, "x", (), Severity.ERROR, "item 1"),
        (REFERENCES, (Ref(1), None), (Ref(1),), Severity.WARNING, "item 2"),
        (NUMBERS, (Real(1.0), None), (), Severity.ERROR, "item 2"),
        (NUMBERS, (Real(1.0), DERIVED), (), Severity.ERROR, "missing"),
    ],
)
def test_odd_value_is_told_and_never_fatal(
    slot: AttributeSlot, value: Value, expected: object, severity: Severity, words: str
) -> None:
    taken, remark = take(slot, value)
    assert taken == expected
    assert remark is not None
    assert remark.severity is severity
    assert words in remark.message


def test_a_remark_says_what_stands_where_what_is_required() -> None:
    _, remark = take(NUMBERS, "x")
    assert remark is not None
    assert remark.message == "item 1: 'x' where a number is required"


def test_list_with_a_hole_gives_no_shifted_coordinates() -> None:
    taken, remark = take(NUMBERS, (Real(1.0), "x", Real(3.0)))
    assert taken == ()
    assert remark is not None
    assert remark.severity is Severity.ERROR


@pytest.mark.parametrize(
    ("slot", "expected", "severity"),
    [
        (AttributeSlot(is_optional=True, plain=(float,)), None, Severity.NOTE),
        (AttributeSlot(is_optional=True, items=NUMBER), None, Severity.NOTE),
        (NUMBERS, (), Severity.NOTE),
        (NUMBER, None, Severity.ERROR),
        (LABEL, "", Severity.ERROR),
    ],
)
def test_parameter_may_be_missing_at_the_end(
    slot: AttributeSlot, expected: object, severity: Severity
) -> None:
    taken, remark = take_missing(slot)
    assert taken == expected
    assert remark is not None
    assert remark.severity is severity


@every_case(
    ("slot", "value", "expected"),
    [
        (NUMBER, 0.5, Real(0.5)),
        (NUMBER, 2, Real(2.0)),
        (COUNT, 2, 2),
        (TRUTH, True, Enumeration("T")),
        (NAME, ToolReferencePoint.TCP, Enumeration("TCP")),
        (AttributeSlot(enumeration=Logical), Logical.UNKNOWN, Enumeration("U")),
        (REFERENCES, (Ref(1),), (Ref(1),)),
        (NUMBERS, (1, 2.5), (Real(1.0), Real(2.5))),
        (FEED, Typed("FEED_PER_REV_TYPE", Real(0.1)), Typed("FEED_PER_REV_TYPE", Real(0.1))),
        (LABEL, "", ""),
        (FEED, None, None),
    ],
)
def test_value_is_given_back_as_its_type_is_written(
    slot: AttributeSlot, value: object, expected: Value
) -> None:
    given = give(slot, value)
    assert given == expected
    assert type(given) is type(expected)


def test_real_that_was_read_keeps_its_characters() -> None:
    taken, _ = take(NUMBER, Real(0.04, "0.040"))
    given = give(NUMBER, taken)
    assert isinstance(given, Real)
    assert given.lexeme == "0.040"


def test_reference_is_not_taken_for_a_number() -> None:
    assert isinstance(give(REFERENCE, Ref(5)), Ref)
    assert take(COUNT, Ref(5))[0] is None


def test_types_within_types_need_no_stack() -> None:
    value: Value = Real(1.0)
    for _ in range(5000):
        value = Typed("SOME_MEASURE", value)
    assert take(NUMBER, value) == (1.0, None)


def test_anything_else_has_no_form() -> None:
    with pytest.raises(TypeError, match="is not a valid attribute value"):
        give(NUMBER, [1.0])
