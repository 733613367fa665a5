"""What ``simulate`` shows is the same whatever way the program comes and is sampled."""

from importlib import resources
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import parquet

import stepnc
from optimiser.solver.problem import LimitName
from service import progress
from service.simulation.code_simulation import CodeRequest
from service.simulation.run import Simulation, simulate
from service.verbs.optimise import program as advising
from simulator.errors import SimulationError
from simulator.machine.totals import Total
from simulator.motion.segments import Floats
from stepnc_model.errors import SchemaError, StepNcError
from stepnc_model.post.dialect import Dialect
from tests.asking import asked_advice, asked_simulation
from tests.every_case import every_case

EXAMPLES = Path(__file__).parents[3] / "examples"
BRACKET = EXAMPLES / "parts" / "bracket.stpnc"
SHAFT = EXAMPLES / "parts" / "shaft.stpnc"
TOOLS = EXAMPLES / "tools" / "bracket.toml"
STOCK = "-3,-3,-40,153,93,2"

MILLS = (
    Dialect.LINUXCNC, Dialect.FANUC, Dialect.HAAS, Dialect.SINUMERIK, Dialect.HEIDENHAIN,
)  # fmt: skip
LATHES = MILLS[:-1]

ROUNDING = 1e-4
"""of time and energy: coordinates of 0.001 mm, speeds of 0.001 rpm, feeds of 0.001 mm/min"""


@pytest.fixture(scope="module")
def part(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A slot and two holes of the bracket, in a folder of their own."""
    text = BRACKET.read_text(encoding="ascii")
    whole = "'MAIN WORKPLAN',(#3,#7,#4,#5,#6)"
    assert whole in text
    path = tmp_path_factory.mktemp("part") / "part.stpnc"
    few = text.replace(whole, "'MAIN WORKPLAN',(#15,#20,#22)")
    path.write_text(few, encoding="ascii")
    return path


@pytest.fixture(scope="module")
def milled(part: Path) -> Simulation:
    return simulate(*asked_simulation(file=part, machine="vmc15"))


@pytest.fixture(scope="module")
def turned() -> Simulation:
    return simulate(*asked_simulation(file=SHAFT, machine="lathe22"))


@pytest.fixture(scope="module")
def face(part: Path) -> Path:
    """The shaft faced."""
    path = part.with_name("face.stpnc")
    text = SHAFT.read_text(encoding="ascii").replace("WORKPLAN',(#3,#4)", "WORKPLAN',(#10)")
    path.write_text(text, encoding="ascii")
    return path


def posted(file: Path, control: Dialect, folder: Path) -> CodeRequest:
    """NC code of a program."""
    code = folder / f"code{control.suffix}"
    stepnc.post(file, control=control.value, output=code)
    return CodeRequest(code=code, dialect=control.value)


def assert_same(run: Simulation, other: Simulation) -> None:
    """Time, energy and removal of each workingstep to rounding."""
    assert [name for name, _ in run.totals] == [name for name, _ in other.totals]
    for (_, one), (_, two) in zip(run.totals, other.totals, strict=True):
        assert one.duration == pytest.approx(two.duration, rel=ROUNDING)
        assert one.energy.total == pytest.approx(two.energy.total, rel=ROUNDING)
        assert one.cutting_energy == pytest.approx(two.cutting_energy, rel=2e-3)
        assert one.volume == pytest.approx(two.volume, rel=2e-3)


def assert_equal(one: Total, two: Total) -> None:
    """Sums of the same in another order."""
    assert one.duration == pytest.approx(two.duration, rel=1e-12)
    assert one.energy.total == pytest.approx(two.energy.total, rel=1e-12)
    assert one.volume == pytest.approx(two.volume, rel=1e-12)
    assert one.force.value == pytest.approx(two.force.value, rel=1e-12)


@pytest.mark.parametrize("control", MILLS)
def test_code_for_a_mill_runs_as_its_program_does(
    part: Path, milled: Simulation, tmp_path: Path, control: Dialect
) -> None:
    code = posted(part, control, tmp_path)
    run = simulate(*asked_simulation(file=part, machine="vmc15", code=code))
    assert_same(run, milled)


@pytest.mark.parametrize("control", LATHES)
def test_code_for_a_lathe_runs_as_its_program_does(
    turned: Simulation, tmp_path: Path, control: Dialect
) -> None:
    code = posted(SHAFT, control, tmp_path)
    run = simulate(*asked_simulation(file=SHAFT, machine="lathe22", code=code))
    assert_same(run, turned)


def test_code_alone_runs_with_a_tool_table_and_a_stock(tmp_path: Path) -> None:
    # The table numbers tools as the whole bracket does.
    code = posted(BRACKET, Dialect.LINUXCNC, tmp_path).code
    text = code.read_text(encoding="ascii")
    holes = text.index("(CENTRE HOLE 1)")
    code.write_text(text[: text.index("(ROUGH FACE)")] + text[holes:], encoding="ascii")
    alone = simulate(
        *asked_simulation(
            code=CodeRequest(code=code, tools=TOOLS, stock=STOCK),
            machine="vmc15",
            material="c45",
        )
    )
    known = simulate(
        *asked_simulation(code=CodeRequest(code=code), file=BRACKET, machine="vmc15")
    )
    assert alone.whole.volume > 0.0
    assert_equal(alone.whole, known.whole)
    assert [name for name, _ in alone.totals if name] == ["T5", "T6", "T7"]
    assert [name for name, _ in known.totals][1:3] == ["CENTRE HOLE 1", "CENTRE HOLE 2"]


def test_code_without_a_stock_takes_its_time_and_cuts_nothing(
    part: Path, milled: Simulation, tmp_path: Path
) -> None:
    code = CodeRequest(code=posted(part, Dialect.HEIDENHAIN, tmp_path).code)
    run = simulate(*asked_simulation(code=code, machine="vmc15"))
    assert run.whole.duration == pytest.approx(milled.whole.duration, rel=ROUNDING)
    assert run.whole.volume == 0.0
    assert "no material is removed" in str(run.findings[0])


def times_and_power(path: Path) -> tuple[np.ndarray, np.ndarray]:
    table = parquet.read_table(path, columns=["time_s", "electric_wattage"])
    return table["time_s"].to_numpy(), table["electric_wattage"].to_numpy()


@pytest.mark.parametrize("rate", [1.0, 100.0, 10_000.0])
def test_samples_come_at_their_rate_and_change_no_total(
    face: Path, tmp_path: Path, rate: float
) -> None:
    path = tmp_path / "run.parquet"
    run = simulate(*asked_simulation(file=face, machine="lathe22", rate=rate, output=path))
    idle = simulate(*asked_simulation(file=face, machine="lathe22"))
    times, power = times_and_power(path)
    assert run.whole == idle.whole
    assert run.samples == len(times)
    np.testing.assert_allclose(times, np.arange(len(times)) / rate)
    assert 0.0 <= times[-1] - run.whole.duration < 1.0 / rate
    if rate >= 100.0:
        assert power.mean() * run.whole.duration == pytest.approx(
            run.whole.energy.total, rel=0.01
        )


@pytest.mark.parametrize("noise", ["normal", "uniform"])
def test_a_seed_is_a_run_to_the_byte(face: Path, tmp_path: Path, noise: str) -> None:
    def written(seed: int, name: str) -> bytes:
        path = tmp_path / name
        simulate(
            *asked_simulation(
                file=face, machine="lathe22", noise=noise, missing=0.1, has_lag=True,
                rate=2.0, seed=seed, output=path,
            )
        )  # fmt: skip
        return path.read_bytes()

    for suffix in (".parquet", ".csv"):
        assert written(1, f"a{suffix}") == written(1, f"b{suffix}") != written(2, f"c{suffix}")


def test_missing_samples_are_empty(face: Path, tmp_path: Path) -> None:
    path = tmp_path / "run.parquet"
    simulate(
        *asked_simulation(file=face, machine="lathe22", missing=0.25, rate=5.0, output=path)
    )
    table = parquet.read_table(path)
    share = table["cutting_force"].null_count / table.num_rows
    assert share == pytest.approx(0.25, abs=0.05)
    assert table["x_axis_position_actual"].null_count == 0
    assert table["workingstep"].null_count == 0


def test_a_control_that_stops_in_each_corner_is_the_slowest(part: Path) -> None:
    def duration(control: str, times: str = "") -> float:
        request = asked_simulation(file=part, machine="vmc15", control=control, filter_s=times)
        return simulate(*request).whole.duration

    stops, corners, filtered = map(duration, ("exact-stop", "junction", "fir"))
    assert corners < stops
    assert duration("fir", "0.5,0.2") > filtered


def test_the_running_workingstep_is_always_there(part: Path, tmp_path: Path) -> None:
    path = tmp_path / "run.parquet"
    simulate(*asked_simulation(file=part, machine="vmc15", output=path))
    names = parquet.read_table(path)["workingstep"].cast(pa.string()).to_pylist()
    order = list(dict.fromkeys(names))
    assert order == ["MILL SLOT", "CENTRE HOLE 1", "DRILL HOLE 1"]


def test_worn_tools_take_more(part: Path, milled: Simulation) -> None:
    worn = simulate(*asked_simulation(file=part, machine="vmc15", has_wear=True))
    assert worn.whole.duration == pytest.approx(milled.whole.duration)
    assert worn.whole.cutting_energy > milled.whole.cutting_energy


def test_teeth_swing_about_the_mean(part: Path, milled: Simulation) -> None:
    request = asked_simulation(file=part, machine="vmc15", force="tooth", runout_um=20.0)
    (_, _), (slot, teeth), *_ = simulate(*request).totals
    assert slot == "MILL SLOT"
    assert teeth.force.value > 1.2 * milled.totals[1][1].force.value


def test_units_that_cannot_be_meant_are_refused_as_by_optimise(part: Path) -> None:
    with pytest.raises(SchemaError, match=r"is below 0\.0005 mm; plausible with --units iso"):
        simulate(*asked_simulation(file=part, machine="vmc15", units="rpm-mmin"))


def test_a_trace_is_kept_for_the_report_alone(part: Path, milled: Simulation) -> None:
    assert milled.trace is None
    request = asked_simulation(file=part, machine="vmc15", report=part.with_name("r.html"))
    run = simulate(*request)
    assert run.trace is not None
    assert run.samples == 0
    assert run.material is not None
    assert run.trace.end[-1] == pytest.approx(run.whole.duration, abs=0.1)


def test_progress_names_share_time_and_workingstep(
    part: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(progress, "INTERVAL", 0.0)
    told: list[str] = []
    simulate(*asked_simulation(file=part, machine="vmc15"), tell=told.append)
    bars = [line for line in told if line.startswith("[")]
    assert "MILL SLOT" in bars[0]
    assert "of machining" in bars[0]
    shares = [int(line.split("]")[1].split("%")[0]) for line in bars]
    assert shares == sorted(shares)
    # All of a single workingstep is read before it runs.
    assert shares[0] < 50
    assert shares[-1] > 90


@pytest.mark.parametrize("suffix", [".parquet", ".csv"])
def test_an_interrupted_run_leaves_what_it_has_beside_the_old_one(
    part: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, suffix: str
) -> None:
    monkeypatch.setattr(progress, "INTERVAL", 0.0)
    told: list[str] = []

    def interrupt(message: str) -> None:
        told.append(message)
        if "CENTRE HOLE 1" in message:
            raise KeyboardInterrupt

    path = tmp_path / f"run{suffix}"
    path.write_text("old", encoding="ascii")
    request = asked_simulation(file=part, machine="vmc15", output=path)
    with pytest.raises(KeyboardInterrupt):
        simulate(*request, tell=interrupt)
    partial = tmp_path / f"run.partial{suffix}"
    assert path.read_text(encoding="ascii") == "old"
    assert sorted(tmp_path.iterdir()) == sorted([path, partial])
    if suffix == ".csv":
        rows = len(partial.read_text(encoding="utf-8").splitlines()) - 1
    else:
        rows = parquet.read_table(partial).num_rows
    assert rows > 100
    assert told[-1] == f"written: {partial} ({rows} samples)"


def test_a_program_that_takes_no_time_is_none(tmp_path: Path) -> None:
    code = tmp_path / "empty.ngc"
    code.write_text("(nothing)\nM30\n", encoding="ascii")
    with pytest.raises(SimulationError, match=r"empty.ngc: the program contains nothing"):
        simulate(
            *asked_simulation(
                code=CodeRequest(code=code), machine="vmc15", output=tmp_path / "run.csv"
            )
        )
    assert list(tmp_path.iterdir()) == [code]


@every_case(
    ("words", "message"),
    [
        ({"rate": float("nan")}, "rate nan Hz: it must be 1 to 10000 Hz"),
        ({"missing": 1.0}, "missing 1"),
        ({"seed": -1}, "seed -1: it must be 0 to 2"),
        ({"runout_um": 10.0}, "--force tooth"),
        ({"runout_um": 1e3, "force": "tooth"}, "runout 1000 µm"),
        ({"deviation": 0.0}, "deviation 0 mm"),
        ({"filter_s": "0.01,0.1"}, "filter times 0.01"),
        (
            {"filter_s": "1,1", "control": "junction"},
            "only for the control",
        ),
        ({"zero": "0,0,inf"}, "zero '0,0,inf'"),
    ],
)
def test_numbers_out_of_their_range_are_refused(words: dict[str, object], message: str) -> None:
    request = asked_simulation(file=SHAFT, machine="lathe22", **words)  # type: ignore[arg-type]
    with pytest.raises(StepNcError, match=message):
        simulate(*request)


def test_lag_is_that_of_the_machine_where_it_is_known(tmp_path: Path) -> None:
    """A slow drive shows the end of the cut late."""
    mill = resources.files("simulator") / "data" / "machines" / "vmc15.toml"
    slow = tmp_path / "slow.toml"
    text = mill.read_text(encoding="utf-8")
    slow.write_text(
        text.replace("efficiency = 0.85\n", "efficiency = 0.85\ndelay_s = 1.5\n", 1)
    )
    runs: list[Floats] = []
    for machine in ("vmc15", str(slow)):
        output = tmp_path / f"{len(runs)}.parquet"
        request = asked_simulation(
            file=EXAMPLES / "parts" / "paper002.stpnc", material="c45", machine=machine,
            has_lag=True, output=output,
        )  # fmt: skip
        simulate(*request)
        runs.append(parquet.read_table(output)["cutting_wattage"].to_numpy())
    usual, late = runs
    assert np.abs(np.diff(late)).max() < 0.5 * np.abs(np.diff(usual)).max()


@pytest.mark.parametrize(
    ("part", "machine"), [("shaft", "lathe22"), ("paper003_case1", "vmc15")]
)
def test_what_is_advised_passes_no_limit_of_the_machine(
    tmp_path: Path, part: str, machine: str
) -> None:
    output = tmp_path / "part.stpnc"
    file = EXAMPLES / "parts" / f"{part}.stpnc"
    advising.advise_program(*asked_advice(file=file, machine=machine, output=output))
    found = simulate(*asked_simulation(file=output, machine=machine))
    assert found.whole.overload_time == 0.0


def test_the_tool_bends_in_the_run_as_far_as_the_plan_says(tmp_path: Path) -> None:
    """The face of paper 002 is held by a deflection of 0.1 mm, and the run shows it."""
    output, samples = tmp_path / "part.stpnc", tmp_path / "run.parquet"
    request = asked_advice(
        file=EXAMPLES / "parts" / "paper002.stpnc",
        machine="vmc15",
        material="c45",
        output=output,
    )
    (advice,) = advising.advise_program(*request).plan.advices
    assert advice.active is LimitName.TOOL_DEFLECTION
    run = simulate(
        *asked_simulation(file=output, machine="vmc15", material="c45", output=samples)
    )
    # Nominal: the bound of 0.1 mm is kept at the 90 % quantile of k_c.
    assert run.whole.deflection.value == pytest.approx(0.1 / 1.2632, rel=0.01)
    column = parquet.read_table(samples)["tool_deflection"].to_numpy()
    assert column.max() == pytest.approx(run.whole.deflection.value, rel=1e-3)
