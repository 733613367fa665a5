"""NC code of any origin on the virtual machine."""

from pathlib import Path

import pytest

from service.requests.runs import SimulationRequest
from service.simulation.run import RunFiles, Simulation, simulate
from service.simulation.setup import CodeRequest
from stepnc_model.errors import StepNcError
from tests.service.along_path.foreign import BAR, BOX, END, HEAD, INSERTS, TOOLS, slot
from tests.service.along_path.test_of_code import PROGRAMS

PLAIN = HEAD + slot(40.0) + END
SLOT = 12.0 * 4.0 * 100.0
"""Volume of the slot, mm³."""


def simulated(
    text: str,
    folder: Path,
    *,
    lathe: bool = False,
    dialect: str = "",
    is_foreign: bool = True,
) -> Simulation:
    """Run of NC code with tools and stock."""
    code, tools = folder / "part.nc", folder / "tools.csv"
    code.write_text(text)
    tools.write_text(INSERTS if lathe else TOOLS)
    request = CodeRequest(
        code=code,
        dialect=dialect,
        tools=tools,
        stock=BAR if lathe else BOX,
        is_foreign=is_foreign,
    )
    machine = "lathe22" if lathe else "vmc15"
    return simulate(SimulationRequest(machine=machine, material="c45"), RunFiles(code=request))


def messages(run: Simulation) -> str:
    """What the findings say, in one text."""
    return "\n".join(f"{each.line}: {each.message}" for each in run.findings)


@pytest.mark.parametrize("name", PROGRAMS)
def test_code_of_many_origins_runs_as_it_is_planned(name: str, tmp_path: Path) -> None:
    text, request = PROGRAMS[name]
    run = simulated(text, tmp_path, lathe=request.machine == "lathe22")
    assert run.whole.volume > 0.0
    assert run.whole.duration > 10.0


def test_small_letters_remove_what_plain_code_removes(tmp_path: Path) -> None:
    plain = simulated(PLAIN, tmp_path, dialect="fanuc", is_foreign=False)
    foreign = simulated(PLAIN.lower().replace("o0001", "; foreign"), tmp_path)
    assert plain.whole.volume == pytest.approx(SLOT, rel=0.002)
    assert foreign.whole.volume == pytest.approx(plain.whole.volume)
    assert foreign.whole.cutting_time == pytest.approx(plain.whole.cutting_time)
    assert "read as code of" in messages(foreign)
    assert "read as code of" not in messages(plain)


def test_what_is_left_out_is_listed_and_removes_nothing(tmp_path: Path) -> None:
    text = HEAD + slot(40.0) + "G68 X0. Y0. R45.\n" + slot(60.0) + "G69\n" + END
    run = simulated(text, tmp_path, dialect="fanuc")
    assert run.whole.volume == pytest.approx(SLOT, rel=0.002)
    assert "left out of the run, and remove nothing: rotated" in messages(run)


def test_the_strict_readers_tell_the_way_out(tmp_path: Path) -> None:
    with pytest.raises(StepNcError, match=r"line 1: .*--foreign runs what is understood"):
        simulated("g20 g64\n", tmp_path, dialect="linuxcnc", is_foreign=False)


def test_without_tools_foreign_code_is_refused(tmp_path: Path) -> None:
    code = CodeRequest(code=tmp_path / "part.nc", is_foreign=True)
    with pytest.raises(StepNcError, match="add --tools, --stock, --machine and --material"):
        simulate(SimulationRequest(machine="vmc15"), RunFiles(code=code))


def test_foreign_code_has_no_program(tmp_path: Path) -> None:
    code = CodeRequest(code=tmp_path / "part.nc", is_foreign=True)
    with pytest.raises(StepNcError, match="omit the program"):
        simulate(SimulationRequest(), RunFiles(file=tmp_path / "part.stpnc", code=code))
