"""The story of the knowledge base: what three runs teach a plan whose catalogue is wrong."""

import runpy
from dataclasses import dataclass
from math import log
from pathlib import Path

import pytest
from scipy.stats import lognorm

EXAMPLE = Path(__file__).parents[2] / "examples" / "03_learning_from_runs.py"


@dataclass(frozen=True)
class Row:
    planned: float
    feed: float
    time: float
    share: float
    learned: float


@pytest.fixture(params=[1.35, 0.85])
def truth(request: pytest.FixtureRequest) -> float:
    """Factor on the catalogue's k_c."""
    found: float = request.param
    return found


@pytest.fixture
def told(
    truth: float, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> list[Row]:
    """What the example prints, run by run."""
    monkeypatch.setattr("sys.argv", [str(EXAMPLE), str(truth)])
    runpy.run_path(str(EXAMPLE), run_name="__main__")
    rows = [line.split() for line in capsys.readouterr().out.splitlines()[2:]]
    return [
        Row(
            planned=float(row[1]),
            feed=float(row[2]),
            time=float(row[3]),
            share=float(row[6]),
            learned=float(row[7]),
        )
        for row in rows
    ]


def test_the_third_run_keeps_its_force_bound_and_uses_it(truth: float, told: list[Row]) -> None:
    first, second, third = told
    # Without anything learned the spread of the catalogue counts: its 70 % quantile.
    assert first.planned == pytest.approx(lognorm.ppf(0.7, s=log(1.2)), rel=1e-3)
    assert first.share == pytest.approx(truth / first.planned, rel=0.03)
    assert 0.9 <= second.share <= 1.0
    assert 0.95 <= third.share <= 1.0
    # Planned with a quantile above the truth, and closer to it with every run.
    assert truth < third.planned <= second.planned
    errors = [abs(row.learned / truth - 1.0) for row in (first, second, third)]
    assert errors == sorted(errors, reverse=True)
    assert errors[-1] < 0.02
    # What was violated takes longer, what was wasted is won.
    assert (third.time > first.time) is (truth > 1.0)
