"""A plan beside its run on the virtual machine."""

import json
from dataclasses import replace
from math import inf
from pathlib import Path
from typing import Any

import pytest

from service.cli.commands import print_result
from service.cli.main import optimise_main
from service.rendering.columns import dump
from service.simulation.confirmation import PASSED, Confirmation, ConfirmedStep, Figure
from service.verbs.optimise import program as advising
from service.verbs.optimise.plan_result import ProgramAdvice
from simulator.errors import SimulationError
from simulator.removal.difference import StockDifference
from stepnc_model.errors import StepNcError
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.task import stock_of
from tests.asking import asked_advice

PARTS = Path(__file__).parents[3] / "examples" / "parts"
OK, LIMIT_EXCEEDED = 0, 5
KEYS = [
    "time_s",
    "cutting_force_n",
    "thrust_n",
    "deflection_um",
    "torque_nm",
    "cutting_power_w",
    "drive_power_w",
    "volume_cm3",
]


@pytest.fixture(scope="module")
def part(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A face, a slot and a hole of the bracket."""
    text = (PARTS / "bracket.stpnc").read_text(encoding="ascii")
    whole = "'MAIN WORKPLAN',(#3,#7,#4,#5,#6)"
    assert whole in text
    path = tmp_path_factory.mktemp("part") / "part.stpnc"
    path.write_text(text.replace(whole, "'MAIN WORKPLAN',(#10,#15,#22)"), encoding="ascii")
    return path


@pytest.fixture(scope="module")
def outcome(part: Path) -> ProgramAdvice:
    return advising.advise_program(
        *asked_advice(file=part, machine="vmc15", dry_run=True, confirm=True)
    )


@pytest.fixture(scope="module")
def confirmation(outcome: ProgramAdvice) -> Confirmation:
    assert outcome.confirmation is not None
    return outcome.confirmation


def figure(
    *, promised: float = 100.0, found: float = 100.0, bound: float = inf, key: str = "time_s"
) -> Figure:
    return Figure(key=key, heading="force N", promised=promised, simulated=found, bound=bound)


def of(step: ConfirmedStep) -> dict[str, Figure]:
    return {each.key: each for each in step.figures}


def test_every_workingstep_has_every_figure(confirmation: Confirmation) -> None:
    assert [step.id for step in confirmation.steps] == [
        "ROUGH FACE",
        "MILL SLOT",
        "DRILL HOLE 1",
    ]
    assert all([each.key for each in step.figures] == KEYS for step in confirmation.steps)


def test_what_was_promised_is_what_the_plan_says(
    outcome: ProgramAdvice, confirmation: Confirmation
) -> None:
    for advice, step in zip(outcome.plan.advices, confirmation.steps, strict=True):
        assert advice.after is not None
        promised = {key: each.promised for key, each in of(step).items()}
        assert promised["time_s"] == advice.after.time
        assert promised["cutting_force_n"] == pytest.approx(advice.after.cutting_force)
        assert promised["thrust_n"] == pytest.approx(advice.after.thrust)
        efficiency = outcome.plan.machine.spindle.efficiency
        power = advice.after.motor_power * efficiency
        assert promised["cutting_power_w"] == pytest.approx(power)
        assert promised["drive_power_w"] > advice.after.motor_power


def test_the_run_keeps_what_the_plan_promised(confirmation: Confirmation) -> None:
    """Times to a thousandth, forces and powers to a hundredth."""
    for step in confirmation.steps:
        for key, each in of(step).items():
            if each.promised == 0.0:
                assert each.simulated == 0.0
                continue
            tolerance = 1e-3 if key == "time_s" else 0.01
            assert each.simulated == pytest.approx(each.promised, rel=tolerance), (step.id, key)


def test_figures_are_of_the_cuts_that_have_them(confirmation: Confirmation) -> None:
    face, slot, hole = map(of, confirmation.steps)
    assert face["deflection_um"].ratio is None
    # Nominal: its bound is kept at the 90 % quantile of k_c.
    assert slot["deflection_um"].bound == pytest.approx(25.0)
    assert slot["deflection_um"].promised == pytest.approx(25.0 / 1.2632, rel=1e-4)
    assert hole["thrust_n"].promised > 1000.0
    assert face["thrust_n"].ratio is None


def test_no_bound_is_passed_by_a_part_that_keeps_its_promises(
    confirmation: Confirmation, part: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert confirmation.passed == ()
    with pytest.raises(SystemExit) as stopped:
        optimise_main([str(part), "--machine", "vmc15", "--confirm", "--dry-run"])
    assert stopped.value.code == OK
    assert "predicted -> found" in capsys.readouterr().out


def test_a_bound_is_passed_from_a_hundredth_above_it() -> None:
    assert not figure(found=100.0 * PASSED, bound=100.0).is_passed
    assert figure(found=101.1, bound=100.0).is_passed
    assert not figure(found=1e9).is_passed
    steps = (ConfirmedStep(id="one", figures=(figure(found=120.0, bound=100.0), figure())),)
    (told,) = Confirmation(steps=steps).passed
    assert told == "one: force N 120 exceeds its bound of 100"


def test_the_ratio_of_nothing_is_none() -> None:
    assert figure(promised=50.0).ratio == 2.0
    assert figure(promised=0.0).ratio is None


def test_json_holds_promise_finding_ratio_and_bound(outcome: ProgramAdvice) -> None:
    found: dict[str, Any] = json.loads(dump(outcome.record()))
    assert found["confirmation"]["passed"] == []
    for step in found["confirmation"]["workingsteps"]:
        assert list(step) == ["id", *KEYS, "stock_left"]
        assert step["stock_left"]["deviation_mm"] == 0.0
        for key in KEYS:
            names = ["promised", "found", "ratio", "bound", "found_at_quantile"]
            assert list(step[key]) == names
    assert found["confirmation"]["quantile"] == 0.9
    face, slot, _ = found["confirmation"]["workingsteps"]
    assert slot["deflection_um"]["bound"] == pytest.approx(25.0)
    assert face["deflection_um"]["ratio"] is None
    assert face["time_s"]["bound"] is None
    assert "confirmation" not in json.loads(dump(replace(outcome, confirmation=None).record()))


def test_a_bound_that_is_passed_is_said_and_is_the_exit_code(
    outcome: ProgramAdvice,
    part: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    step = ConfirmedStep(id="ROUGH FACE", figures=(figure(found=130.0, bound=110.0),))
    worse = replace(outcome, confirmation=Confirmation(steps=(step,)))
    monkeypatch.setattr(
        "service.verbs.optimise.run.advise_program", lambda request, files, tell: worse
    )
    with pytest.raises(SystemExit) as stopped:
        optimise_main([str(part), "--confirm", "--dry-run"])
    assert stopped.value.code == LIMIT_EXCEEDED
    shown, told = capsys.readouterr()
    assert "100 -> 130 (1.300)" in shown
    assert "not as planned: ROUGH FACE: force N 130 exceeds its bound of 110" in shown + told


def test_bounds_are_compared_at_the_quantile(confirmation: Confirmation) -> None:
    """The slot keeps 25 µm at the quantile that is planned, and comes near them there."""
    slot = of(confirmation.steps[1])["deflection_um"]
    assert slot.at_quantile == pytest.approx(slot.simulated * 1.2632, rel=1e-3)
    assert slot.at_quantile == pytest.approx(25.0, rel=0.01)
    nominal = figure(found=100.0, bound=110.0)
    assert not nominal.is_passed
    worse = ConfirmedStep(id="SLOT", figures=(replace(nominal, at_quantile=126.0),))
    (told,) = Confirmation(steps=(worse,), quantile=0.9).passed
    assert told.endswith("126 at the 90 % quantile of k_c exceeds its bound of 110")


def test_other_stock_counts_as_not_confirmed() -> None:
    left = StockDifference(volume=720.0, deviation=0.8)
    steps = (ConfirmedStep(id="SLOT", figures=(), left=left),)
    (told,) = Confirmation(steps=steps).passed
    assert (
        told
        == "SLOT: leaves up to 0.8 mm more (0.72 cm³ more in all) than the program as given"
    )
    same = replace(steps[0], left=StockDifference(volume=0.01))
    assert Confirmation(steps=(same,)).passed == ()


def test_a_machine_without_axes_is_refused_before_anything_is_planned() -> None:
    asked = asked_advice(
        PARTS / "paper002.stpnc", machine="paper002", dry_run=True, confirm=True
    )
    told: list[str] = []
    with pytest.raises(SimulationError, match="no data for its axes X, Y, Z"):
        advising.advise_program(*asked, tell=told.append)
    assert told == []


def test_a_program_that_draws_no_raw_part_needs_one(part: Path, tmp_path: Path) -> None:
    bare = tmp_path / "bare.stpnc"
    text = part.read_text(encoding="ascii")
    assert ",0.05,$,$,#33,(" in text
    bare.write_text(text.replace(",0.05,$,$,#33,(", ",0.05,$,$,$,("), encoding="ascii")
    asked = asked_advice(file=bare, machine="vmc15", dry_run=True, confirm=True)
    with pytest.raises(StepNcError, match=r"cannot be confirmed.*--stock"):
        advising.advise_program(*asked)


def test_a_raw_part_that_is_named_is_the_one_that_the_file_would_draw(
    part: Path, tmp_path: Path, confirmation: Confirmation
) -> None:
    bare = tmp_path / "bare.stpnc"
    text = part.read_text(encoding="ascii")
    bare.write_text(text.replace(",0.05,$,$,#33,(", ",0.05,$,$,$,("), encoding="ascii")
    named = stock_of(Program.load(part), None)
    assert named is not None
    numbers = ",".join(map(str, (*named.low, *named.high)))
    asked = asked_advice(file=bare, machine="vmc15", dry_run=True, confirm=True, stock=numbers)
    assert advising.advise_program(*asked).confirmation == confirmation


def test_without_it_nothing_is_run(part: Path, capsys: pytest.CaptureFixture[str]) -> None:
    outcome = advising.advise_program(*asked_advice(file=part, machine="vmc15", dry_run=True))
    assert outcome.confirmation is None
    print_result(outcome)
    assert "promised" not in capsys.readouterr().out
