"""Options of ``control --linuxcnc`` that contradict each other are refused before a start."""

from pathlib import Path

import pytest

from service.requests.runs import ControlRequest
from service.verbs.control.request import ControlFiles
from service.verbs.control.run import run
from stepnc_model.errors import StepNcError

PART = Path(__file__).parents[3] / "examples" / "parts" / "paper002.stpnc"


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"linuxcnc": "bench", "nc": None}, "name the program and the NC code"),
        ({"linuxcnc": "bench", "load_pin": "vfd.load"}, "the bench has none"),
        ({"linuxcnc": "/run/s"}, "needs --load-pin, or --virtual-load"),
        (
            {"linuxcnc": "/run/s", "load_pin": "vfd.load", "virtual_load": True},
            "one of them",
        ),
        (
            {"linuxcnc": "/run/s", "virtual_load": True, "band": "50,120"},
            "takes 100 % at most, not 120 %",
        ),
        ({"linuxcnc": "/run/none", "virtual_load": True}, "no component of LinuxCNC listens"),
    ],
)
def test_what_linuxcnc_cannot_do_is_refused(
    options: dict[str, object], words: str, tmp_path: Path
) -> None:
    code = tmp_path / "part.ngc"
    code.write_text(
        "G17 G21 G90 G94\nM52 P1\nT1 M6\nS600 M3\nG0 X9 Y-11 Z5\nG1 Z0 F120\nY0\nM2\n"
    )
    files = ControlFiles(file=PART, **{"nc": code, **options})  # type: ignore[arg-type]
    with pytest.raises(StepNcError, match=words):
        run(ControlRequest(machine="vmc15"), files)
