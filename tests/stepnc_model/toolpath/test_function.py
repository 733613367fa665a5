"""NC functions between workingsteps."""

from stepnc_model.part21.values import Ref
from stepnc_model.toolpath.path import Function


def test_a_function_without_text_says_nothing() -> None:
    assert Function(ref=Ref(1), keyword="OPTIONAL_STOP", id="CHECK").text == ""
