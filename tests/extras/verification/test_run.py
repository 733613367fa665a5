"""Injected errors are found at their place with their size; logs of other runs are refused."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import parquet

from benchmarks.verification import (
    CLEAN,
    ERRORS,
    OFFSETS,
    SHAFT_ERRORS,
    SHAFT_REQUEST,
    SHORT_OFFSETS,
    InjectedError,
    RunLog,
    found,
    offset,
    run_log,
    shown,
)
from extras.verification.facts import surface_deviations
from extras.verification.model.deviation import SurfaceKind
from extras.verification.run import VerificationInputs, verified, verify
from stepnc_model.errors import StepNcError
from stepnc_model.programs.program import Stock
from tests.extras.verification.runs import (
    REQUEST,
    fast_log,
    program,
    shaft,
    shaft_log,
    slow_log,
)

BRACKET = Path(__file__).parents[3] / "examples" / "parts" / "bracket.stpnc"
NAMED = {error.name: error for error in ERRORS}
SLOW_CASES = (OFFSETS[2], *(NAMED[name] for name in ("skipped pass", "radius of T4", "none")))


@pytest.mark.parametrize("error", SLOW_CASES, ids=lambda error: error.name)
def test_errors_at_100_hz_and_250_mm_min(error: object, tmp_path: Path) -> None:
    assert error in SLOW_CASES
    case = next(each for each in SLOW_CASES if each is error)
    answer = found(case, slow_log(), program(), folder=tmp_path, request=REQUEST)
    assert answer.is_right
    assert answer.verification.has_errors == bool(case.size)


@pytest.mark.parametrize(
    "error",
    [CLEAN, NAMED["lost second"], offset(0.15), offset(0.15, "FINISH CONTOUR")],
    ids=lambda error: error.name,
)
def test_errors_at_10_hz_and_1000_mm_min(error: object, tmp_path: Path) -> None:
    case = error if isinstance(error, type(CLEAN)) else CLEAN
    assert found(case, fast_log(), program(), folder=tmp_path, request=REQUEST).is_right


def test_an_error_is_told_with_the_workingstep_that_made_it(tmp_path: Path) -> None:
    answer = found(offset(0.15), fast_log(), program(), folder=tmp_path, request=REQUEST)
    assert answer.spot is not None
    assert answer.spot.cut_by == "FINISH POCKET"
    assert answer.spot.time == pytest.approx(440.0, abs=60.0)


def changed(log: RunLog, positions: object) -> RunLog:
    return replace(log, position=np.asarray(positions, dtype=np.float64))


def test_positions_in_inches_are_refused(tmp_path: Path) -> None:
    log = changed(fast_log(), fast_log().position / 25.4)
    with pytest.raises(StepNcError, match="they are in inches"):
        verified(log.write(tmp_path / "log.parquet", program()), program(), REQUEST)


def test_a_log_of_another_program_is_refused(tmp_path: Path) -> None:
    log = changed(fast_log(), fast_log().position[:, [1, 0, 2]] * [2.0, 0.3, 1.0])
    with pytest.raises(StepNcError, match="is it a run of this program"):
        verified(log.write(tmp_path / "log.parquet", program()), program(), REQUEST)


def test_a_zero_is_given_or_fitted_and_does_not_hide_an_error(tmp_path: Path) -> None:
    log = changed(fast_log(), fast_log().position + np.array([-300.0, 20.0, 0.15]))
    path = log.write(tmp_path / "log.parquet", program())
    given = verified(path, program(), replace(REQUEST, zero="-300,20,0.15"))
    assert not given.has_errors
    fitted = verified(path, program(), replace(REQUEST, zero="fit"))
    assert fitted.zero == (-300.0, 20.0, 0.0)
    assert fitted.has_errors
    assert "fitted to whole millimetres" in fitted.findings[0].message


def test_a_tool_that_the_log_never_shows_is_told(tmp_path: Path) -> None:
    log = fast_log()
    other = replace(log, tool=np.where(log.tool == 5, 6, log.tool))
    answer = verified(other.write(tmp_path / "log.parquet", program()), program(), REQUEST)
    assert any("never shows T5" in each.message for each in answer.findings)


def test_measured_tools_must_be_of_the_program(tmp_path: Path) -> None:
    table = tmp_path / "tools.toml"
    table.write_text('[[tool]]\nnumber = 40\nkind = "endmill"\ndiameter_mm = 10\n', "utf-8")
    with pytest.raises(StepNcError, match="T40 is not in the program"):
        verify(
            tmp_path / "log.parquet",
            BRACKET,
            REQUEST,
            inputs=VerificationInputs(tools=table),
        )


@pytest.mark.parametrize("error", SHAFT_ERRORS, ids=lambda error: f"{error.name} {error.size}")
def test_errors_on_a_turned_part(error: object, tmp_path: Path) -> None:
    case = next(each for each in SHAFT_ERRORS if each is error)
    assert found(case, shaft_log(), shaft(), folder=tmp_path, request=SHAFT_REQUEST).is_right


def fast_shaft_log() -> RunLog:
    return run_log(shaft(), rate=10.0, feed=lambda speed: np.full_like(speed, 1000.0 / 60.0))


def test_what_is_left_at_the_bottom_of_a_groove_is_found_at_10_hz(tmp_path: Path) -> None:
    groove = SHORT_OFFSETS[0]
    answer = found(groove, fast_shaft_log(), shaft(), folder=tmp_path, request=SHAFT_REQUEST)
    assert answer.is_right
    assert answer.spot is not None
    assert answer.spot.uncertainty < 0.5 * groove.size


@pytest.mark.parametrize("error", SHORT_OFFSETS[1:4], ids=["-X", "+Z", "-Z"])
def test_gouges_of_a_groove_are_certain_where_a_sample_shows_them(
    error: InjectedError, tmp_path: Path
) -> None:
    answer = found(error, fast_shaft_log(), shaft(), folder=tmp_path, request=SHAFT_REQUEST)
    spot = max((spot for _, spot in answer.spots), key=lambda each: each.least)
    assert 0.12 < spot.least <= 0.15 < spot.uncertainty
    assert "at least 0.1" in shown(answer)
    assert answer.verification.has_errors


def test_a_face_is_found_at_10_hz(tmp_path: Path) -> None:
    face = SHORT_OFFSETS[4]
    assert found(
        face, fast_shaft_log(), shaft(), folder=tmp_path, request=SHAFT_REQUEST
    ).is_right


def test_the_predicted_deflection_is_added_to_walls(tmp_path: Path) -> None:
    path = fast_log().write(tmp_path / "log.parquet", program())
    answer = verified(path, program(), replace(REQUEST, has_deflection=True))
    bent = {(row.workingstep, row.kind): row.bent for row in surface_deviations(answer)}
    assert bent["FINISH POCKET", SurfaceKind.FLOOR] is None
    found_bent = bent["FINISH POCKET", SurfaceKind.WALL]
    assert found_bent is not None
    assert 0.001 < found_bent < 0.1


def test_a_stock_beside_the_path_is_refused(tmp_path: Path) -> None:
    path = fast_log().write(tmp_path / "log.parquet", program())
    beside = Stock(low=(1000.0, 0.0, -40.0), high=(1100.0, 90.0, 0.0))
    with pytest.raises(StepNcError, match="leaves no wall"):
        verified(path, replace(program(), stock=beside), REQUEST)


def test_a_long_gap_cuts_nothing_and_is_told(tmp_path: Path) -> None:
    log = fast_log()
    rows = np.flatnonzero(log.within(program(), "FINISH POCKET"))
    begin = log.time[rows[len(rows) // 4]]
    lost = log.only((log.time < begin) | (log.time > begin + 20.0))
    answer = verified(lost.write(tmp_path / "log.parquet", program()), program(), REQUEST)
    assert answer.volumes.gouge < 20.0
    assert any("1 gap of up to 20" in each.message for each in answer.findings)


def test_workingsteps_of_another_program_are_told(tmp_path: Path) -> None:
    path = fast_log().write(tmp_path / "log.parquet", program())
    table = parquet.read_table(path)
    names = [f"{name} 2" for name in table.column("workingstep").to_pylist()]
    at = table.column_names.index("workingstep")
    parquet.write_table(table.set_column(at, "workingstep", pa.array(names)), path)
    answer = verified(path, program(), REQUEST)
    assert any("does not have: " in each.message for each in answer.findings)
