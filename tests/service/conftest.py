"""A small run of a machine, made by hand."""

import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from kbe.store import open_store
from service.control.run import ControlRun, control
from service.plots.buckets import BucketedRun
from service.simulation.code_simulation import CodeRequest
from service.simulation.run import Simulation
from service.simulation.run_collector import TraceKeeper
from simulator.library import load_machine
from simulator.machine.samples import Samples
from simulator.machine.totals import Energy, Peak, Total
from simulator.motion.model_name import ControlModelName
from simulator.motion.segments import Floats
from stepnc_model.errors import Finding, Severity
from stepnc_model.outcome import ProcessOutcome
from tests.asking import AskedControl, asked_control
from tests.service.shop import shop

NAME = "<script>alert('a & b')</script>"

SampleMaker = Callable[[Floats, Floats], Samples]


def made_samples(time: Floats, force: Floats) -> Samples:
    """Samples at some times with some force; all else follows from the force."""
    count = len(time)
    ones, zeros = np.ones(count), np.zeros(count, dtype=np.int64)
    three = np.outer(ones, (1.0, 2.0, 3.0))
    return Samples(
        time=time,
        position=three,
        velocity=np.outer(ones, (3.0, 4.0, 0.0)),
        feed_programmed=5.0 * ones,
        spindle_programmed=20.0 * ones,
        spindle_speed=20.0 * ones,
        axis_power=three,
        spindle_power=100.0 + 2.0 * force,
        coolant_power=500.0 * ones,
        base_power=1200.0 * ones,
        cutting_power=2.0 * force,
        cutting_force=force,
        feed_force=0.3 * force,
        back_force=0.2 * force,
        removal_rate=0.1 * force,
        chip_thickness=0.1 * ones,
        thrust=0.0 * ones,
        deflection=2e-5 * force,
        axial_depth=ones,
        radial_width=ones,
        execution=zeros + 1,
        path_mode=zeros + 2,
        coolant=zeros + 1,
        overload=(force > 900.0).astype(np.int64),
        line=zeros,
        tool=zeros + 1,
        workingstep=zeros + 1,
    )


@pytest.fixture(scope="session")
def samples_at() -> SampleMaker:
    return made_samples


@pytest.fixture(scope="session")
def simulation() -> Simulation:
    """Two workingsteps after a second of waiting; the first has an evil name."""
    idle = Total(duration=1.0, waiting_time=1.0, energy=Energy(base=1200.0))
    rough = Total(
        duration=60.0,
        cutting_time=40.0,
        rapid_time=5.0,
        waiting_time=4.0,
        energy=Energy(
            x_axis=1100.0, y_axis=900.0, z_axis=300.0, spindle=120_000.0, coolant=30_000.0,
            base=72_000.0,
        ),
        cutting_energy=60_000.0,
        volume=20_000.0,
        power=Peak(value=4500.0, time=30.0, line=12),
        force=Peak(value=950.0, time=31.0, line=13),
        chip=Peak(value=0.12, time=32.0, line=14),
        deflection=Peak(value=0.0234, time=33.0, line=15),
        overload_time=2.5,
    )  # fmt: skip
    finish = Total(
        duration=39.0,
        cutting_time=30.0,
        rapid_time=1.0,
        energy=Energy(spindle=20_000.0, coolant=19_500.0, base=46_800.0),
        cutting_energy=4000.0,
        volume=1000.0,
        power=Peak(value=900.0, time=70.0, line=40),
    )
    return Simulation(
        program="a&b <i>.stpnc",
        machine=load_machine("vmc15"),
        control=ControlModelName.FIR,
        totals=(("", idle), (NAME, rough), ("FINISH", finish)),
        findings=(
            Finding(severity=Severity.WARNING, message="spares <b>no</b> tool", line=7),
            Finding(severity=Severity.WARNING, message="spares <b>no</b> tool", line=7),
        ),
    )


@pytest.fixture(scope="session")
def trace() -> BucketedRun:
    """100 s at 10 Hz."""
    time = np.arange(1001) / 10.0
    keeper = TraceKeeper()
    keeper.add(made_samples(time, 500.0 + 450.0 * np.sin(time)))
    return keeper.trace()


CONTROLLED = """(MILL SLOT)
G17 G21 G40 G49 G54 G80 G90 G94
T1 M6
S3000 M3
G0 X-12 Y50 Z5
Z-2
G1 X20 F600
G0 Z5
M30
"""

Controlled = Callable[..., AskedControl]


@pytest.fixture(scope="session")
def controlled(tmp_path_factory: pytest.TempPathFactory) -> Controlled:
    """A short slot of a public program, to be run under control."""
    code = tmp_path_factory.mktemp("control") / "slot.ngc"
    code.write_text(CONTROLLED, encoding="ascii")
    program = Path(__file__).parents[2] / "examples" / "parts" / "paper003_case1.stpnc"

    def request(**changed: object) -> AskedControl:
        return asked_control(program, code=CodeRequest(code=code), machine="vmc15", **changed)  # type: ignore[arg-type]

    return request


@pytest.fixture(scope="session")
def control_run(controlled: Controlled, tmp_path_factory: pytest.TempPathFactory) -> ControlRun:
    """That slot with a harder second half, kept for plots."""
    report = tmp_path_factory.mktemp("report") / "run.html"
    words = ("hardness:+40%@7.5s", "kc:1.1", "mode:QC@900s")
    return control(*controlled(disturbances=words, report=report, set_point=400.0))


@pytest.fixture(scope="session")
def shop_outcomes() -> tuple[ProcessOutcome, ...]:
    """Two hundred runs of a shop."""
    return tuple(shop(200))


@pytest.fixture(scope="session")
def shop_file(
    tmp_path_factory: pytest.TempPathFactory, shop_outcomes: tuple[ProcessOutcome, ...]
) -> Path:
    """A knowledge base of them; for all tests, so never to be written."""
    path = tmp_path_factory.mktemp("shop") / "shop.db"
    with open_store(str(path)) as store:
        store.add(shop_outcomes)
    return path


@pytest.fixture
def kb(tmp_path: Path, shop_file: Path) -> str:
    """A knowledge base of them, for one test."""
    return str(shutil.copy(shop_file, str(tmp_path / "kb.db")))
