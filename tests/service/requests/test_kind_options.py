"""Options serve kinds of programs as declared, on the command line and over REST."""

from dataclasses import replace
from pathlib import Path

import pytest

from service.cli.main import main
from service.inputs.program_kind import ProgramKind
from service.requests.fields import fields_of
from service.requests.kind_options import SERVES, require_served
from service.requests.stored_advice import StoredAdviceRequest
from stepnc_model.errors import StepNcError
from tests.every_case import every_case

PART = Path(__file__).parents[3] / "examples" / "parts" / "paper002.stpnc"
CODE = "%\nO0001\nG21 G90 G17\nT1 M6\nS5000 M3\nG0 X0. Y0.\nG1 Z-2. F100.\nM30\n%\n"


@every_case(
    ("words", "told"),
    [
        (
            ("--workingstep", "NOSUCH"),
            "--workingstep cannot be used with NC code: NC code has no",
        ),
        (("--mode", "EC"), "--mode cannot be used with NC code"),
        (("--free", "feed"), "--free cannot be used with NC code"),
        (("--records", "all"), "--records cannot be used with NC code"),
        (("--units", "iso"), "--units cannot be used with NC code"),
        (("--confirm",), "--confirm cannot be used with NC code"),
        (("--write-toolpaths",), "--write-toolpaths cannot be used with NC code"),
        (("--nc", "haas"), "--nc cannot be used with NC code"),
    ],
)
def test_options_of_a_step_nc_program_are_refused_with_nc_code(
    words: tuple[str, ...], told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "part.nc"
    file.write_text(CODE)
    with pytest.raises(SystemExit) as ended:
        main(["optimise", str(file), *words])
    assert ended.value.code == 3
    assert told in capsys.readouterr().err
    assert [each.name for each in tmp_path.iterdir()] == ["part.nc"]


@every_case(
    "words",
    [
        ("--greatest-rise", "3"), ("--finish", "T1"), ("--keep", "T1"), ("--unroll",),
        ("--dialect", "haas"), ("--mark",), ("--most-repeats", "9"),
    ],
)  # fmt: skip
def test_options_of_nc_code_are_refused_with_a_step_nc_program(
    words: tuple[str, ...], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["optimise", str(PART), "-o", str(tmp_path / "out.stpnc"), *words])
    assert ended.value.code == 3
    assert f"{words[0]} cannot be used with a STEP-NC program: " in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_the_declaration_names_fields_of_the_request() -> None:
    fields = {each.name: each for each in fields_of(StoredAdviceRequest)}
    assert set(SERVES) - set(fields) == {"most_repeats", "setup"}
    of_code = {
        name for name, each in fields.items() if each.about.text.startswith("of NC code")
    }
    assert of_code == {
        name for name, each in SERVES.items() if each.kind is ProgramKind.NC_CODE
    } - {"tools_unit", "most_repeats", "setup"}


def test_a_request_is_refused_by_its_values() -> None:
    request = StoredAdviceRequest()
    for kind in ProgramKind:
        require_served(request, kind)
    with pytest.raises(StepNcError, match=r"centre_cutting cannot be used with NC code"):
        require_served(replace(request, centre_cutting={"A": True}), ProgramKind.NC_CODE)
    with pytest.raises(StepNcError, match=r"--greatest-rise cannot be used with a STEP-NC"):
        require_served(replace(request, greatest_rise=5.0), ProgramKind.STEP_NC)
