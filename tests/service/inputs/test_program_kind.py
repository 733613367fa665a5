"""The content of a program tells what it is."""

from pathlib import Path

from service.inputs.program_kind import ProgramKind, kind_of
from tests.every_case import every_case
from tests.service.rest.samples import CODE, PARTS


@every_case("file", sorted(PARTS.glob("*.stpnc")))
def test_samples_are_step_nc(file: Path) -> None:
    data = file.read_bytes()
    assert kind_of(data) is ProgramKind.STEP_NC
    assert kind_of(data[data.index(b"#") :]) is ProgramKind.STEP_NC


@every_case(
    "data",
    [
        CODE,
        b"0 BEGIN PGM PLATE MM\n1 BLK FORM 0.1 Z X+0 Y+0 Z-20\n",
        b"%_N_PLATE_MPF\nG710\nX=IC(5)\n",
        b"o<drill> sub\n#1=COS[30]\no<drill> endsub\nM2\n",
        b"(from ISO-10303-21 file)\nN10 G21\nN20 G1 X1 F100\n",
        b"/N5 G1 X1.\r\n",
        b"#1=5 (depth)\nG1 Z-#1\n",
    ],
)
def test_code_of_controls_is_nc_code(data: bytes) -> None:
    assert kind_of(data) is ProgramKind.NC_CODE


@every_case(
    "data",
    [
        b"", b"\0" * 1000, b"%PDF-1.7", b"no program at all", b"time_s,x\n0,1,2\n",
        b"/* G1 X1 */ ISO-10303-21;\nDATA;\n#1=A();\n", b"ISO-10303-21;\nG1 X1\n",
        b"G1 X1\0",
    ],
)  # fmt: skip
def test_the_reader_of_step_nc_says_what_is_wrong_with_the_rest(data: bytes) -> None:
    assert kind_of(data) is ProgramKind.STEP_NC
