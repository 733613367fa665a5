"""The verb ``control``: from a file to what the loop found."""

from collections.abc import Callable
from dataclasses import replace
from math import exp
from pathlib import Path

import pytest
from pyarrow import parquet

from controller.cycle import LoopCycle
from controller.orders import Criterion, EventKind
from service.control.holding import OFF
from service.control.run import ControlRun, control, prepare
from simulator.plant.controlled_machine import TrueState
from stepnc_model.errors import StepNcError
from tests.asking import AskedControl, asked_control
from tests.every_case import every_case

Controlled = Callable[..., AskedControl]


def test_records_cover_the_whole_run(control_run: ControlRun) -> None:
    assert not control_run.is_stopped
    assert sum(record.time for _, record in control_run.steps) == pytest.approx(
        control_run.time
    )
    assert control_run.progress == pytest.approx(control_run.time_planned)
    assert [advice and advice.workingstep.id for advice, _ in control_run.steps][-1] == (
        "MILL SLOT"
    )


def test_a_harder_work_is_met_by_a_lower_override(control_run: ControlRun) -> None:
    _, record = control_run.steps[-1]
    assert record.override < 1.0
    assert record.over_time < 0.1 * record.cutting_time
    # 1.1 from the start, 1.1 times 1.4 later.
    assert 1.1 < exp(record.ratio.log_mean) < 1.54


def test_without_control_the_program_runs_as_it_is(controlled: Controlled) -> None:
    run = control(*controlled(law="none"))
    _, record = run.steps[-1]
    assert run.time == pytest.approx(run.time_planned, rel=1e-9)
    assert (record.least, record.greatest) == pytest.approx((1.0, 1.0))
    assert [*run.held[record.workingstep].seconds] == [OFF]


def test_an_order_switches_the_mode(controlled: Controlled) -> None:
    run = control(*controlled(disturbances=("mode:QC@0s",)))
    assert run.criterion is Criterion.QC
    assert run.steps[-1][1].greatest <= 1.0 + 1e-9
    assert EventKind.ORDER in {event.kind for event in run.events}


def test_watchers_see_every_cycle_and_the_truth(controlled: Controlled) -> None:
    seen: list[tuple[float, float]] = []

    def watch(cycle: LoopCycle, truth: TrueState) -> None:
        seen.append((cycle.reading.period, truth.force))

    run = control(*controlled(), watchers=[watch])
    assert sum(period for period, _ in seen) == pytest.approx(run.time)
    assert max(force for _, force in seen) > 100.0


def test_a_run_that_is_broken_off_leaves_what_it_has(
    controlled: Controlled, tmp_path: Path
) -> None:
    output = tmp_path / "run.parquet"
    told: list[str] = []

    def interrupt(cycle: LoopCycle, _truth: TrueState) -> None:
        if cycle.reading.time > 7.0:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        control(*controlled(output=output), tell=told.append, watchers=[interrupt])
    partial = tmp_path / "run.partial.parquet"
    assert [each.name for each in tmp_path.iterdir()] == [partial.name]
    table = parquet.read_table(partial)
    assert told[-1] == f"written: {partial} ({table.num_rows} rows)"
    assert table["time_s"][-1].as_py() == pytest.approx(7.0, abs=0.05)


def test_nothing_is_kept_that_nobody_asked_for(controlled: Controlled) -> None:
    run = prepare(*controlled()).result()
    assert (run.samples, run.trace) == (0, None)


@every_case(
    ("changed", "message"),
    [
        ({"law": "pid"}, "law 'pid'"),
        ({"mode": "EC"}, "mode 'EC'"),
        ({"sensor": "ear"}, "sensor 'ear'"),
        ({"seed": -1}, "seed -1"),
        ({"look_ahead": 0}, "look-ahead 0 "),
        ({"look_ahead": 51}, "1 to 50"),
        ({"set_point": 0.0}, "force 0 N"),
        ({"set_point": 9.0}, "above 10 N"),
        ({"set_point": float("nan")}, "force nan N"),
        ({"set_point": float("inf")}, "force inf N"),
        ({"band": (0.0, 120.0)}, "band from 0 %"),
        ({"band": (120.0, 20.0)}, "band from 120 %"),
        ({"band": (20.0, 1e9)}, "band to 1e+09 %"),
        ({"band": (float("nan"), 120.0)}, "band from nan %"),
        ({"disturbances": ("depth:+50%",)}, "add a time"),
        ({"disturbances": ("material:butter@1s",)}, "material 'butter'"),
        ({"disturbances": ("tooth:50@1s",)}, "tooth 50"),
    ],
)
def test_what_cannot_be_is_refused(
    controlled: Controlled, changed: dict[str, object], message: str
) -> None:
    with pytest.raises(StepNcError) as caught:
        control(*controlled(**changed))
    assert message in str(caught.value)


def test_a_refusal_names_the_setting_the_value_and_its_bounds(controlled: Controlled) -> None:
    with pytest.raises(StepNcError) as caught:
        control(*controlled(look_ahead=51))
    assert str(caught.value) == "look-ahead 51 revolutions: it must be 1 to 50 revolutions"


def test_nc_code_alone_says_nothing_of_limits(controlled: Controlled) -> None:
    request, files = controlled()
    with pytest.raises(StepNcError, match="control needs a STEP-NC program"):
        control(request, replace(files, file=None))


def test_a_program_without_end_is_refused(controlled: Controlled, tmp_path: Path) -> None:
    request, files = controlled()
    code = tmp_path / "slow.ngc"
    code.write_text("G21\nG4 P90000\nM30\n", encoding="ascii")
    assert files.code is not None
    slow = replace(files, code=replace(files.code, code=code))
    with pytest.raises(StepNcError, match=r"9e\+04 s of machining exceeds 86400 s"):
        control(request, slow)


def test_a_file_that_is_not_there_is_named() -> None:
    request = asked_control(Path("nowhere.stpnc"))
    with pytest.raises(StepNcError, match=r"nowhere\.stpnc: No such file"):
        control(*request)


def test_a_machine_that_is_lost_is_told_and_left_with_the_safe_override(
    controlled: Controlled,
) -> None:
    told: list[str] = []
    session = prepare(*controlled(disturbances=("line:off@8s",)))
    run = control(*controlled(disturbances=("line:off@8s",)), tell=told.append)
    assert run.is_stopped
    assert run.time == pytest.approx(8.0, abs=0.3)
    assert run.events[-1].kind is EventKind.LOST
    assert "lost: the machine has not answered since 8." in told[-1]
    assert sum(1 for _ in session.cycles()) > 0
    assert session.machine.commanded == 0.5


def test_the_power_of_the_drive_serves_a_program_of_one_cut(controlled: Controlled) -> None:
    run = control(*controlled(sensor="power", set_point=250.0))
    _, record = run.steps[-1]
    assert record.revolutions > 50
    assert record.override < 1.0
    assert exp(record.ratio.log_mean) == pytest.approx(1.0, abs=0.05)
