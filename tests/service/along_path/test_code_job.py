"""Corrections of the knowledge base and work-holding serve NC code."""

from dataclasses import replace
from datetime import UTC, datetime
from math import log
from pathlib import Path

import numpy as np
import pytest

from kbe.store import open_store
from optimiser.along_path.caps import CapName
from service.requests.advice import AdviceRequest
from service.verbs.optimise.code import optimise_code
from service.verbs.optimise.code_result import CodeAdvice
from service.verbs.optimise.request import AdviceFiles
from stepnc_model.errors import StepNcError
from stepnc_model.outcome import Context, LearnedCorrection
from tests.service.along_path.foreign import END, HEAD, INSERTS, LATHE, MILL, TOOLS

SLOT = HEAD + "G0 X-10. Y40.\nZ-8.\nG1 X110. F400.\nG0 Z20.\n" + END
BAR = (
    "%\nO0001\nG21 G40 G99\nT0101\nG97 S1200 M3\nG0 X55. Z2.\nG0 X44.\n"
    "G1 Z-30. F0.2\nX52.\nG0 X100. Z50.\nM30\n%\n"
)
VICE = (
    '[[holding]]\nkind = "vice"\nholding_force_kn = {force}\nfriction = 0.2\nsource = "test"\n'
)
CHUCK = (
    '[[holding]]\nkind = "chuck"\nclamping_force_kn = {force}\nfriction = 0.2\n'
    'source = "test"\n'
    "jaw_face_z_mm = -45\ngrip_length_mm = 15\n"
)


def advice(
    folder: Path, text: str, request: AdviceRequest = MILL, **files: object
) -> CodeAdvice:
    program, tools = folder / "part.nc", folder / "tools.csv"
    program.write_text(text)
    tools.write_text(INSERTS if request.machine == "lathe22" else TOOLS)
    given = AdviceFiles(file=program, tools=tools, dry_run=True)
    return optimise_code(request, replace(given, **files))  # type: ignore[arg-type]


def held(folder: Path, text: str) -> Path:
    file = folder / "holding.toml"
    file.write_text(text)
    return file


def share(found: CodeAdvice, name: CapName) -> float:
    return sum(
        step.plan.shares.get(name, (0.0, 0.0))[0] for step in found.along.steps if step.plan
    )


@pytest.mark.parametrize(
    ("text", "request_", "table"),
    [(SLOT, MILL, VICE), (BAR, LATHE, CHUCK)],
    ids=["vice", "chuck"],
)
def test_a_weak_holding_bounds_the_feed_along_the_path(
    text: str, request_: AdviceRequest, table: str, tmp_path: Path
) -> None:
    strong, weak = (
        advice(tmp_path, text, request_, holding=held(tmp_path, table.format(force=force)))
        for force in (1e3, 8.0)
    )
    free = advice(tmp_path, text, request_)
    assert share(free, CapName.HOLDING) == share(strong, CapName.HOLDING) == 0.0
    assert strong.along.time_after == pytest.approx(free.along.time_after)
    assert share(weak, CapName.HOLDING) > 25.0
    assert weak.along.time_after > free.along.time_after


def test_a_chuck_whose_grip_nothing_tells_is_refused(tmp_path: Path) -> None:
    table = CHUCK.replace("jaw_face_z_mm = -45\n", "").format(force=50.0)
    with pytest.raises(StepNcError, match=r"jaw_face_z_mm: missing; NC code and its stock"):
        advice(tmp_path, BAR, LATHE, holding=held(tmp_path, table))


def test_an_accepted_correction_slows_its_tool(tmp_path: Path) -> None:
    now = datetime(2026, 1, 1, tzinfo=UTC)
    learned = LearnedCorrection(
        context=Context(machine="vmc15", material="c45", tool="endmill T1"),
        log_centre=log(1.6), log_scale=0.02, degrees=30.0, outcomes=12, confidence=0.99,
        proposed_at=now,
    )  # fmt: skip
    place = str(tmp_path / "k.db")
    with open_store(place) as store:
        store.accept(store.propose(learned), by="Ann", at=now)
    request = replace(MILL, safety=0.5)
    plain = advice(tmp_path, SLOT, request)
    found = advice(tmp_path, SLOT, request, kb=place)
    assert any("learned k_c × 1.600" in each.message for each in found.findings)
    assert share(plain, CapName.TOOL_DEFLECTION) > 50.0
    # The feed at a force is that at the nominal k_c over 1.6^(1/(1 − m_c)).
    m_c = found.material.material.kienzle.m_c
    slow, fast = (
        min(
            part.rate
            for parts in each.along.feeds.values()
            for part in parts
            if part.reason == "tool deflection"
        )
        for each in (found, plain)
    )
    assert np.isclose(slow / fast, 1.6 ** (-1.0 / (1.0 - m_c)), rtol=0.02)
    ignored = advice(tmp_path, SLOT, replace(request, has_corrections=False), kb=place)
    assert ignored.rewritten.data == plain.rewritten.data


def test_a_knowledge_base_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(StepNcError, match="nonexistent"):
        advice(tmp_path, SLOT, kb=str(tmp_path / "nonexistent.db"))
