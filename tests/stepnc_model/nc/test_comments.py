"""Comments and tool calls of NC code."""

import pytest

from stepnc_model.nc.comments import CalledTool, CodeComment, FirstMotion, remarks_of
from stepnc_model.nc.text import text_of
from stepnc_model.post.dialect import Dialect


def found(code: str, dialect: Dialect = Dialect.FANUC) -> list[str]:
    """What is found, in short."""
    names = []
    for each in remarks_of(text_of(code.encode(), dialect), dialect):
        match each:
            case CodeComment(text=text):
                names.append(text)
            case CalledTool(number=number, line=line):
                names.append(f"T{number} line {line}")
            case FirstMotion():
                names.append("motion")
    return names


def test_comments_nest_and_follow_semicolons() -> None:
    assert found("(a (b) c)\n;d\n") == ["a (b) c", "d"]


@pytest.mark.parametrize(
    ("code", "calls"),
    [
        ("T1 M6\n", ["T1 line 1"]),
        ("M06 T1\n", ["T1 line 1"]),
        ("T1\nG4 P1\nM6\n", ["T1 line 3"]),
        ("T1 M6\nG4 P1\nT2\n", ["T1 line 1"]),
        ("T3\n", ["T3 line 1"]),
        ("G65 P1 A#1T5\n", ["T5 line 1"]),
        ("#T1\n(T9 M6)\n", ["T9 M6"]),
    ],
)
def test_a_tool_word_calls_where_the_program_changes_tools_so(
    code: str, calls: list[str]
) -> None:
    assert found(code) == calls


def test_klartext_has_calls_and_structure_blocks() -> None:
    code = "1 * - T5 D=6\n2 TOOL CALL 5 Z S100 ; D6\n3 L X+1 FMAX\n4 TOOL DEF 6\n"
    words = found(code, Dialect.HEIDENHAIN)
    assert words == ["T5 D=6", "T5 line 2", "D6", "motion"]


def test_sinumerik_has_parentheses_for_arguments() -> None:
    assert found("MSG(T1 M6)\n", Dialect.SINUMERIK) == ["T1 line 1"]
    assert found("T=3 M6 ; mill\n", Dialect.SINUMERIK) == ["T3 line 1", "mill"]


def test_motion_is_told_once_behind_what_may_be_about_it() -> None:
    assert found("X1\nX2\n(a)\nX3\nX4\n") == ["a", "motion"]
