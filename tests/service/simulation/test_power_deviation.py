"""``simulate --power-deviation``: seeded, in file and totals alike, milling and turning."""

import re
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from pyarrow import parquet

from extras.agent.run import simulated_with_document
from service.cli.commands import print_result
from service.simulation.run import Simulation, simulate
from service.verbs.simulate.result import SimulateResult
from simulator.client.document_choices import DocumentChoice, NameSet, SchemaVersion
from stepnc_model.errors import StepNcError
from tests.asking import asked_simulation

PARTS = Path(__file__).parents[3] / "examples" / "parts"


def run(
    name: str, machine: str, *, seed: int | None, output: Path | None = None, rate: float = 10.0
) -> Simulation:
    return simulate(
        *asked_simulation(
            PARTS / f"{name}.stpnc",
            machine=machine,
            has_power_deviation=seed is not None,
            seed=seed or 0,
            output=output,
            rate=rate,
        )
    )


@pytest.mark.parametrize(
    ("name", "machine"), [("paper003_case2", "paper003"), ("paper000", "paper000")]
)
def test_a_seed_gives_one_energy_and_another_seed_another(name: str, machine: str) -> None:
    plain = run(name, machine, seed=None).whole.energy
    first, again, other = (run(name, machine, seed=seed).whole.energy for seed in (1, 1, 2))
    assert first == again
    assert first.spindle != other.spindle
    for energy in (first, other):
        assert (energy.base, energy.coolant) == (plain.base, plain.coolant)
        assert 0.9 <= energy.spindle / plain.spindle <= 1.1
        assert 0.9 <= energy.x_axis / plain.x_axis <= 1.1
        assert energy.spindle != plain.spindle


def test_samples_in_the_file_integrate_to_the_totals(tmp_path: Path) -> None:
    """At 100 Hz; the spindle's ramps begin and end between two samples."""
    output = tmp_path / "run.parquet"
    whole = run("paper003_case2", "paper003", seed=3, output=output, rate=100.0).whole
    table = parquet.read_table(output)
    time, total = table["time_s"].to_numpy(), table["electric_wattage"].to_numpy()
    assert np.trapezoid(total, time) == pytest.approx(whole.energy.total, rel=3e-4)


def test_the_document_shows_the_powers_of_the_file(tmp_path: Path) -> None:
    output, document = tmp_path / "run.parquet", tmp_path / "run.xml"
    request, files = asked_simulation(
        PARTS / "paper000.stpnc",
        machine="paper000",
        has_power_deviation=True,
        seed=3,
        output=output,
    )
    shown = DocumentChoice(version=SchemaVersion.V1_3, names=NameSet.PAPERS)
    simulated_with_document(request, files, document, shown)
    found = re.findall(
        r'<Wattage dataItemId="c_axis_wattage"[^>]*>([\d.]+)<', document.read_text("utf-8")
    )
    shown_watts = np.array(list(map(float, found)))
    drawn = parquet.read_table(output)["c_axis_wattage"].to_numpy()
    plain = tmp_path / "plain.parquet"
    run("paper000", "paper000", seed=None, output=plain)
    exact = parquet.read_table(plain)["c_axis_wattage"].to_numpy()

    def apart(watts: NDArray[np.float64]) -> NDArray[np.float64]:
        """Distance of each value of the document from the nearest of a file, W."""
        distance: NDArray[np.float64] = np.abs(shown_watts[:, None] - watts).min(axis=1)
        return distance

    assert len(shown_watts) > 20
    assert apart(drawn).max() < 0.01
    assert apart(exact).max() > 10.0


def test_the_sampling_rate_does_not_change_the_run() -> None:
    slow, fast = (run("paper003_case2", "paper003", seed=3, rate=rate) for rate in (1.0, 50.0))
    assert slow.whole == fast.whole


def test_the_result_tells_the_deviation_and_its_seed(
    capsys: pytest.CaptureFixture[str],
) -> None:
    simulation = run("paper003_case2", "paper003", seed=7)
    print_result(SimulateResult(simulation=simulation))
    shown = capsys.readouterr().out
    assert "deviates by up to ±10 % in feed and ±5 % in rapid, seed 7" in shown
    said = SimulateResult(simulation=simulation).record()["power_deviation"]
    assert said == {"feed": 0.1, "traverse": 0.05, "seed": 7}
    plain = SimulateResult(simulation=run("paper003_case2", "paper003", seed=None)).record()
    assert plain["power_deviation"] is None


def test_a_machine_without_a_deviation_is_refused(tmp_path: Path) -> None:
    text = (PARTS.parents[1] / "simulator/data/machines/vmc15.toml").read_text("utf-8")
    own = tmp_path / "own.toml"
    own.write_text(text[: text.index("[deviation]")], encoding="utf-8")
    with pytest.raises(StepNcError, match=r"machine 'own' states no power deviation: .*table"):
        run("paper003_case2", str(own), seed=1)
