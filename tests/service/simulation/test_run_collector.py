"""What a run leaves on the way: totals by workingstep, samples for all who look at them."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from service.simulation.code_simulation import CodeRequest
from service.simulation.run import simulate
from service.simulation.run_collector import MOST_SECONDS
from simulator.errors import SimulationError
from simulator.machine.samples import Samples
from tests.asking import asked_simulation
from tests.service.rest.samples import SAMPLE


class Looker:
    """Keeps what it is shown."""

    def __init__(self) -> None:
        self.workingsteps: Sequence[str] | None = None
        self.samples: list[Samples] = []

    def begin(self, workingsteps: Sequence[str]) -> None:
        assert self.workingsteps is None
        self.workingsteps = workingsteps

    def add(self, samples: Samples) -> None:
        self.samples.append(samples)


REQUEST = asked_simulation(file=SAMPLE, rate=20.0)


def test_a_looker_sees_each_sample_once_ascending_in_time() -> None:
    looker = Looker()
    simulation = simulate(*REQUEST, watchers=[looker])
    times = np.concatenate([each.time for each in looker.samples])
    assert (np.diff(times) > 0.0).all()
    assert times[-1] == pytest.approx(simulation.whole.duration, abs=0.06)
    assert looker.workingsteps is not None
    assert list(looker.workingsteps) == [id for id, _ in simulation.totals if id]


def test_lookers_change_nothing_and_see_the_same() -> None:
    one, other = Looker(), Looker()
    watched = simulate(*REQUEST, watchers=[one, other])
    alone = simulate(*REQUEST)
    assert watched.totals == alone.totals
    assert len(one.samples) == len(other.samples)
    for mine, yours in zip(one.samples, other.samples, strict=True):
        assert np.array_equal(mine.cutting_force, yours.cutting_force)


def test_what_a_looker_raises_ends_the_run() -> None:
    class Stubborn(Looker):
        def add(self, samples: Samples) -> None:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        simulate(*REQUEST, watchers=[Stubborn()])


def test_a_run_without_an_end_is_refused_at_the_line_that_has_none(tmp_path: Path) -> None:
    code = tmp_path / "dwell.ngc"
    code.write_text(f"G21 G90\nG4 P{2.0 * MOST_SECONDS:.0f}\nM30\n", encoding="ascii")
    with pytest.raises(
        SimulationError, match=r"line 2: 2e\+07 s of machining: the limit is 1e\+07 s"
    ):
        simulate(*asked_simulation(code=CodeRequest(code=code), machine="vmc15"))
