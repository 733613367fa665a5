"""Errors about an attribute name the option that sets it."""

from stepnc_model.errors import Finding, Severity
from stepnc_model.programs.remedy import error_of, with_remedy
from tests.every_case import every_case


@every_case(
    ("entity", "attribute", "value"),
    [
        ("#47 DRILLING", "its_tool", "#ID"),
        ("#31 ROUND_HOLE", "depth", "VALUE"),
        ("#31 ROUND_HOLE", "diameter", "VALUE"),
        ("#61 MILLING_TECHNOLOGY", "spindle", "VALUE"),
        ("#4 TURNING_WORKINGSTEP", "its_features", "(#ID,...)"),
        ("#95 CARTESIAN_POINT", "coordinates", "(VALUE,...)"),
    ],
)
def test_the_value_is_shown_as_it_is_typed(entity: str, attribute: str, value: str) -> None:
    number = entity.split(maxsplit=1)[0]
    option = f'--set "{number}.{attribute}={value}"'
    assert with_remedy("is wrong", entity, attribute) == f"is wrong; set it with {option}"


@every_case(
    ("message", "entity", "attribute"),
    [
        ("is missing; --feed gives one", "#61 MILLING_TECHNOLOGY", "feedrate"),
        ("is wrong", "#61 MILLING_TECHNOLOGY", ""),
        ("contains itself", "#2 WORKPLAN", "its_elements"),
        ("is wrong", "#61 MILLING_TECHNOLOGY", "its_colour"),
        ("is wrong", "#61 SOMETHING_ELSE", "its_tool"),
        ("is wrong", "", ""),
    ],
)
def test_where_no_option_helps_the_message_stays(
    message: str, entity: str, attribute: str
) -> None:
    assert with_remedy(message, entity, attribute) == message


def test_a_finding_becomes_an_error_at_its_place() -> None:
    finding = Finding(
        severity=Severity.ERROR,
        message="#9 does not exist",
        entity="#47 DRILLING",
        attribute="its_tool",
        line=3,
    )
    assert str(error_of(finding)) == (
        'line 3: #47 DRILLING.its_tool: #9 does not exist; set it with --set "#47.its_tool=#ID"'
    )
