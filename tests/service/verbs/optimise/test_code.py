"""Feeds along the paths of NC code of any origin."""

import re
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from optimiser.along_path.caps import CapName
from optimiser.along_path.tool_bounds import bounds_of_tool
from service.along_path.run import along_path
from service.along_path.task import task_of
from service.cli.commands import print_result
from service.rendering.columns import dump
from service.requests.advice import AdviceRequest
from service.requests.program_facts import RawPart, StockFile
from service.verbs.optimise.code import optimise_code, source_of
from service.verbs.optimise.code_result import CodeAdvice
from service.verbs.optimise.program import advise_program as optimise
from service.verbs.optimise.request import AdviceFiles
from simulator.removal.engage import MillingStock
from simulator.removal.stock_file import stock_bytes
from stepnc_model.errors import StepNcError
from stepnc_model.post.dialect import Dialect
from stepnc_model.programs.program import Stock
from tests.extras.verification.files import write_stl
from tests.extras.verification.model.box import box
from tests.service.along_path.foreign import (
    END,
    HEAD,
    LATHE,
    MILL,
    advised,
    lines_of,
    paths_of,
    rewritten,
    slot,
)
from tests.service.along_path.samples import BRACKET

FEED = re.compile(r" ?F[0-9.]+")

WITHIN = 1.01
"""Greatest found load over its bound."""

SUBPROGRAMS = (
    HEAD + "G0 X-10. Y10.\nZ-4.\nM98 P2 L2\nG90 G0 Z20.\nT2 M6\nS4000 M3\nG0 X-10. Y60.\nZ-3.\n"
    "M98 P2\nG90 G0 Z20.\nM30\nO0002\nG91 G1 X120. F60.\nY8.\nX-120.\nY8.\nM99\n%\n"
)
CYCLES = (
    HEAD + slot(10.0) + "T5 M6\nS2000 M3\nG0 X20. Y50.\nZ5.\n"
    "G98 G83 X20. Y50. Z-15. R2. Q4. F150.\nX40.\nX60.\nG80\nG0 Z50.\n" + END
)
INCH = (
    HEAD.replace("G21", "G20") + "G0 X-.5 Y.5\nZ-.15\nG1 X4.5 F12.\nY1.\nX-.5\nG0 Z1.\n" + END
)
ARCS = (
    HEAD + "G0 X-10. Y15. Z5.\nG1 Z-5. F200.\nX80. F800.\nG3 X90. Y25. R10.\nG1 Y60.\n"
    "G3 X80. Y70. I-10. J0.\nG2 X60. Y50. Z-8. I0. J-20. F300.\nG1 X20.\nG0 Z15.\n" + END
)
INVERSE = (
    HEAD + "G0 X-10. Y10.\nZ-3.\nG93 G1 X50. F5.\nX110. F5.\nG94 Y30. F300.\nX-10.\n" + END
)
FREECAD = (
    "(Exported by FreeCAD)\nG17 G54 G40 G49 G80 G90\nG21\nM6 T2\nG43 H2\nM3 S3000\n"
    "G0 Z8.000\nG0 X-15.000 Y40.000\nG0 Z5.000\nG1 X-15.000 Y40.000 Z-4.000 F100.000\n"
    "G1 X10.000 Y40.000 Z-4.000 F600.000\n"
    "G2 X50.000 Y80.000 Z-4.000 I40.000 J0.000 K0.000 F600.000\n"
    "G1 X110.000 Y80.000 Z-4.000 F600.000\nG0 Z8.000\nM5\nM2\n"
)
MASTERCAM = (
    "%\nO0000(T)\nN100 G21\nN102 G0 G17 G40 G49 G80 G90\nN104 T1 M6\n"
    "N106 G0 G90 G54 X-15. Y40. S3000 M3\nN108 G43 H1 Z25.\nN110 Z5.\nN112 G1 Z-3. F150.\n"
    "N114 X40. F500.\nN116 G41 D1 X50. Y30.\nN118 X90.\nN120 Y70.\nN122 X50.\n"
    "N124 G40 X40. Y60.\nN126 Y20.\nN128 X110.\nN130 G0 Z25.\nN134 G91 G28 Z0.\nN138 M30\n%\n"
)
SINUMERIK = (
    "N10 G71 G90 G17 G54\nN20 T1 D1\nN30 M6\nN40 S3000 M3\nN50 G0 X-15 Y10 Z5\n"
    "N60 G1 Z-4 F200\nMARK1: G91 G1 X130 F60\nY12\nX-130\nY5\nG90\nREPEAT MARK1 P=1\n"
    "N100 G0 Z50\nN110 MCALL CYCLE82(5,0,2,-10,0,0.5)\nN130 X20 Y60 F100\nN150 MCALL\nM30\n"
)
KLARTEXT = (
    "0 BEGIN PGM A MM\n1 TOOL CALL 1 Z S3000 F500\n2 L X-15 Y+10 R0 FMAX M3\n"
    "3 L Z+5 FMAX\n4 L Z-4 F200\n5 L X+50 F600\n6 CC X+50 Y+30\n7 C X+70 Y+30 DR+\n"
    "8 L Y+70\n9 L X+115\n10 L Z+50 FMAX\n11 L X+5 Y+5 RL F300\n12 L X+5 Y+90 R0\n"
    "13 L Z+100 R0 FMAX M30\n14 END PGM A MM\n"
)
TURNED = (
    "%\nO0001\nG21 G40 G99\nG50 S2500\nT0101\nG96 S180 M3\nG0 X55. Z2.\nG0 X46.\n"
    "G1 Z-40. F0.25\nX52.\nG0 Z2.\nX42.\nG1 Z-30.\nX52.\nG0 X100. Z50.\nT0303\n"
    "G97 S800 M3\nG0 X52. Z-30.\nG1 X36. F0.08\nG0 X60.\nG0 X100. Z50.\nM30\n%\n"
)
PROGRAMS = {
    "subprograms": (SUBPROGRAMS, MILL),
    "cycles": (CYCLES, MILL),
    "inch": (INCH, MILL),
    "arcs and helix": (ARCS, MILL),
    "inverse time": (INVERSE, MILL),
    "freecad": (FREECAD, MILL),
    "mastercam": (MASTERCAM, MILL),
    "sinumerik": (SINUMERIK, replace(MILL, dialect=Dialect.SINUMERIK)),
    "heidenhain": (KLARTEXT, replace(MILL, dialect=Dialect.HEIDENHAIN)),
    "turning": (TURNED, LATHE),
}


@pytest.mark.parametrize("name", PROGRAMS)
def test_the_rewritten_program_takes_the_planned_time_and_stays(name: str) -> None:
    text, request = PROGRAMS[name]
    first = advised(text, request)
    again = advised(rewritten(text, request), request)
    assert first.rewritten.changed > 0
    assert first.along.time_after == pytest.approx(first.along.planned_time, rel=0.005)
    assert again.rewritten.changed == again.rewritten.added == 0
    assert again.along.time_before == pytest.approx(first.along.time_after)


@pytest.mark.parametrize("name", PROGRAMS)
def test_loads_keep_their_bounds(name: str) -> None:
    found = advised(*PROGRAMS[name])
    greatest = found.machine.max_cutting_force
    for step in found.along.steps:
        if step.plan is None:
            continue
        permitted = max(WITHIN * (greatest or np.inf), step.before.force.value)
        assert step.after.force.value <= permitted, step.name


@pytest.mark.parametrize("name", ["arcs and helix", "freecad"])
def test_the_run_meets_what_was_planned_for_a_sharp_edge(name: str) -> None:
    text, request = PROGRAMS[name]
    request = replace(request, safety=0.5)
    found = advised(text, request)
    code = paths_of(text)
    assert code.material is not None
    for part, step in zip(code.parts, found.along.steps[1:], strict=True):
        bounds = bounds_of_tool(
            code.tools[part.tool], code.machine, code.material.material, quantile=0.5,
            is_finishing=part.is_finishing, roughness=None,
        )  # fmt: skip
        assert bounds is not None
        bent = step.after.deflection.value / bounds.at.deflection.value
        assert 0.5 < bent <= WITHIN


def test_a_rapid_straight_out_of_the_material_cuts_nothing() -> None:
    """A slot that ends in the block: 60 mm and half a cutter of 12 mm, 4 mm deep."""
    text = HEAD + "G0 X-10. Y40.\nZ-4.\nG1 X60. F300.\nG0 Z20.\n" + END
    slot_volume = 4.0 * (12.0 * 60.0 + 0.5 * np.pi * 6.0**2)
    step = advised(text).along.steps[1]
    for run in (step.before, step.after):
        assert run.volume == pytest.approx(slot_volume, rel=0.004)


@pytest.mark.parametrize("name", PROGRAMS)
def test_all_but_feeds_and_split_blocks_stays_byte_for_byte(name: str) -> None:
    text, request = PROGRAMS[name]
    changed = advised(text, request).along.feeds
    kept = [
        FEED.sub("", line)
        for number, line in enumerate(text.splitlines(), start=1)
        if number not in changed
    ]
    new = [FEED.sub("", line) for line in rewritten(text, request).splitlines()]
    place = 0
    for line in kept:
        place = new.index(line, place) + 1


def test_unrolled_calls_have_feeds_of_their_own() -> None:
    """Both calls of the first tool go through the same slot: the second one meets nothing."""
    request = replace(MILL, greatest_rise=1000.0)
    whole = advised(SUBPROGRAMS, request)
    single = advised(SUBPROGRAMS, replace(request, is_unrolled=True))
    assert single.along.time_after < 0.95 * whole.along.time_after
    assert single.along.time_before == pytest.approx(whole.along.time_before)
    words = single.rewritten.data.decode("latin-1")
    assert "M98" not in words
    again = advised(words, request)
    assert again.rewritten.changed == 0


def test_no_feed_is_below_the_least_one() -> None:
    least = replace(MILL, least_feed_mm_min=2000.0, greatest_rise=1000.0, allow_plunge=True)
    arcs = ARCS.replace("X-10.", "X-20.")  # clear of the block
    free, floored = advised(arcs), advised(arcs, least)
    rates = [part.rate for parts in free.along.feeds.values() for part in parts]
    assert min(rates) < 2000.0 / 60.0
    for found in re.findall(r"F([0-9.]+)", floored.rewritten.data.decode("latin-1")):
        assert float(found) >= 2000.0 * (1.0 - 1e-3)
    assert floored.along.time_after < free.along.time_after
    told = " ".join(each.message for each in floored.findings)
    assert "demand less than the least feed (--least-feed)" in told
    again = advised(floored.rewritten.data.decode("latin-1"), least)
    assert again.rewritten.changed == 0
    with pytest.raises(StepNcError, match=r"least feed 2000 mm/min .* above the greatest feed"):
        advised(ARCS, replace(least, max_feed_mm_min=1000.0))


def test_a_subprogram_for_two_tools_has_the_feed_that_both_permit() -> None:
    def feed(text: str) -> float:
        any_rise = replace(MILL, greatest_rise=1000.0)
        return advised(text, any_rise).along.feeds[lines_of(text, "X120.")[0]][0].rate

    calls, sub = (
        SUBPROGRAMS[: SUBPROGRAMS.index("M30")],
        SUBPROGRAMS[SUBPROGRAMS.index("M30") :],
    )
    change = calls.index("T2 M6")
    # Called twice, its blocks stay in one piece as well.
    once = calls[change:].replace("M98 P2\n", "M98 P2 L2\n")
    first, second = calls[:change] + sub, HEAD + once + sub
    assert feed(SUBPROGRAMS) == pytest.approx(min(feed(first), feed(second)), rel=0.02)
    assert feed(first) != pytest.approx(feed(second), rel=0.02)


DEFINED = {
    Dialect.HEIDENHAIN: (
        "0 BEGIN PGM A MM\n1 TOOL CALL 5 Z S2000 F200\n2 L Z+50 R0 FMAX M3\n"
        "3 CYCL DEF 200 DRILLING ~\n Q200=2 ~\n Q201=-10 ~\n Q206=+30 ~\n Q202=10 ~\n"
        " Q203=+0 ~\n Q204=50\n4 L X+20 Y+20 R0 FMAX M99\n5 L X+40 R0 FMAX M99\n"
        "6 L Z+50 R0 FMAX M30\n7 END PGM A MM\n",
        "Q206=+30",
        r"Q206=(\S+) ~",
    ),
    Dialect.SINUMERIK: (
        "N10 G71 G90 G17 G54\nN20 T5 D1\nN30 M6\nN40 S2000 M3\nN50 G0 X20 Y20 Z5\n"
        "N60 F30\nN70 MCALL CYCLE82(5,0,2,-10,0,0.5)\nN80 X20 Y20\nN90 X40\nN100 MCALL\n"
        "N110 G0 Z50\nM30\n",
        "F30",
        r"N60 F(\S+)",
    ),
}


@pytest.mark.parametrize("dialect", DEFINED)
def test_a_defined_cycle_gets_its_feed_where_it_is_given(dialect: Dialect) -> None:
    """The feed is that of the same holes drilled by Fanuc's cycle, in one place of the file."""
    text, old, pattern = DEFINED[dialect]
    request = replace(MILL, dialect=dialect)
    result = advised(text, request)
    new = result.rewritten.data.decode()
    found = re.search(pattern, new)
    assert found is not None
    assert result.rewritten.changed == 1
    assert new == text.replace(old, found[0].split(" ")[-1] if old[0] == "F" else found[0][:-2])
    fanuc = HEAD.replace("T1", "T5").replace("S3000", "S2000") + (
        "G0 X20. Y20.\nZ5.\nG99 G81 X20. Y20. Z-10. R2. F30.\nX40.\nG80\nG0 Z50.\n"
    )
    same = re.search(r"R2\. F([0-9.]+)", rewritten(fanuc + END))
    assert same is not None
    assert float(found[1]) == pytest.approx(float(same[1]), rel=0.01)
    assert float(found[1]) > 60.0


def test_a_tool_that_meets_no_stock_keeps_its_feeds() -> None:
    text = HEAD + slot(10.0) + "T2 M6\nS3000 M3\n" + slot(40.0).replace("Z-4.", "Z30.") + END
    found = advised(text)
    assert sorted(found.along.feeds) == lines_of(text, "G1 X110.")[:1]
    said = next(each for each in found.findings if "T2 meets no stock" in each.message)
    assert "do the stock and G54 have the same zero?" in said.message


MISSING = {
    "no feed F is in force": slot(10.0).replace(" F300.", ""),
    "the feed is 0": slot(10.0).replace("F300.", "F0."),
    "a feed per revolution while the spindle is stopped": "M5\nG95\n"
    + slot(10.0).replace("F300.", "F0.1"),
    "the tool is not in the tool table": "T9 M6\nS3000 M3\n" + slot(10.0),
    "cutter radius compensation": "G0 Y40.\nG41 D1 X-10. Y10.\nZ-4.\nG1 X110. F300.\nG40 Y0.\n",
}


@pytest.mark.parametrize("what", MISSING)
def test_what_is_missing_is_told_and_the_bytes_stay(what: str) -> None:
    text = HEAD + MISSING[what] + END
    found = advised(text, replace(MILL, dialect=Dialect.FANUC))
    assert found.rewritten.data == text.encode("latin-1")
    said = "\n".join(each.message for each in found.findings)
    assert what in said
    assert "no feed of this program may be chosen" in said


HELIX = (
    "G21 G90 G17 G54\nT2 M6\nS3000 M3\nG0 X51. Y40. Z5.\nZ0.9\n{turns}"
    "G3 I-1. J0. F300.\nG0 Z20.\nM2\n"
)


@pytest.mark.parametrize("depth", [3.0, 12.0])
def test_a_helix_of_many_turns_has_the_time_of_its_turns(depth: float) -> None:
    """The steeper one is limited by its plunge, the other by the chip."""
    request = replace(MILL, dialect=Dialect.LINUXCNC)
    bottom = 0.9 - depth
    ends = [0.9 - depth * turn / 3.0 for turn in (1, 2, 3)]
    single = "".join(f"G3 X51. Y40. Z{z:.4f} I-1. J0. F300.\n" for z in ends)
    joined = f"G3 X51. Y40. Z{bottom:.4f} I-1. J0. P3 F300.\n"
    one, other = (advised(HELIX.format(turns=turns), request) for turns in (joined, single))
    plan = one.along.steps[1].plan
    assert plan is not None
    names = {name for name, (length, _) in plan.shares.items() if length > 10.0}
    assert (CapName.PLUNGE in names) is (depth > 10.0)
    assert one.along.time_after == pytest.approx(other.along.time_after, rel=0.02)
    assert one.rewritten.added > 0


def test_a_program_that_calls_itself_is_refused_with_the_line() -> None:
    with pytest.raises(StepNcError, match=r"line 6: .*nested more than 50 deep"):
        advised(HEAD + "M98 P1\n" + END)


def test_a_turning_tool_that_cuts_nothing_where_a_bound_is_broken_gives_a_plan() -> None:
    text, request = PROGRAMS["turning"]
    assert advised(text[:164] + text[169:], request).along is not None


@settings(max_examples=15, deadline=None)
@given(st.data())
def test_mutilated_programs_give_a_plan_or_a_message(data: st.DataObject) -> None:
    text, request = PROGRAMS[data.draw(st.sampled_from(sorted(PROGRAMS)))]
    at = data.draw(st.integers(0, len(text) - 1))
    count = data.draw(st.integers(0, 9))
    put = data.draw(st.text(alphabet="GMXYZFST/#[](),.-19\n", max_size=6))
    with suppress(StepNcError):
        advised(text[:at] + put + text[at + count :], request)


OVER = (
    HEAD + slot(10.0) + "G0 X0. Y40.\nZ2.5\nG1 X90. F300.\nG0 Z20.\n"
    "X0. Y40.\nZ0.5\nG1 X90. F300.\nG0 Z20.\n" + END
)
"""A slot, then passes in air, 2.5 mm and 0.5 mm over the block."""


def stocks(folder: Path) -> dict[str, RawPart]:
    """The same block as numbers, as a mesh, and as an earlier run left it."""
    write_stl(folder / "part.stl", box((0.0, 0.0, -20.0), (100.0, 80.0, 0.0)))
    block = Stock(low=(0.0, 0.0, -20.0), high=(100.0, 80.0, 0.0))
    (folder / "left.npz").write_bytes(stock_bytes(MillingStock(block, cell=0.25)))
    return {
        "box": "0,0,-20,100,80,0",
        "bar": "50,40,150,-20,0",
        "mesh": StockFile(path=folder / "part.stl"),
        "kept": StockFile(path=folder / "left.npz"),
    }


@pytest.mark.parametrize("kind", ["box", "bar", "mesh", "kept"])
def test_within_the_margin_of_the_stock_nothing_is_air(kind: str, tmp_path: Path) -> None:
    stock = stocks(tmp_path)[kind]
    _, high, low = lines_of(OVER, "G1 X110.", "G1 X90.")

    def middle(line: int, margin: float) -> float:
        request = replace(MILL, stock=stock, stock_margin_mm=margin)
        code = paths_of(OVER, stock=stock)
        # Caution would keep both passes as they are.
        source = replace(source_of(request, code, rise=1.0), caution=None)
        parts = along_path(source, task_of(request, code.machine)).feeds[line]
        return next(part.rate for part in parts if part.end > 0.5)

    fast = middle(high, 1.0)
    assert middle(low, 1.0) < 0.5 * fast
    assert middle(high, 3.0) < 0.5 * fast
    assert middle(low, 0.0) == pytest.approx(fast, rel=0.05)


def test_the_frame_of_the_stock_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    found = advised(HEAD.replace("G54", "G56") + slot(10.0) + END)
    print_result(found)
    assert "the stock stands in G56" in capsys.readouterr().out
    assert '"frame": "G56"' in dump(found.record())


def test_messages_of_the_planned_run_name_lines_of_the_file() -> None:
    text = HEAD + slot(10.0) + "G0 X50. Y40. Z5.\nG0 Z-2.\nG0 Z20.\n" + END
    found = advised(text)
    hit = next(each for each in found.findings if "a rapid move cuts" in each.message)
    assert hit.line == lines_of(text, "G0 Z-2.")[0]


@pytest.fixture(scope="module")
def own(tmp_path_factory: pytest.TempPathFactory) -> CodeAdvice:
    """Advice for our own NC code of the bracket."""
    folder = tmp_path_factory.mktemp("own")
    request = AdviceRequest(machine="vmc15", nc_control=Dialect.LINUXCNC)
    optimise(request, AdviceFiles(file=BRACKET, output=folder / "one.stpnc"))
    tools = BRACKET.parents[1] / "tools" / "bracket.toml"
    return optimise_code(
        AdviceRequest(machine="vmc15", material="c45", stock="-3,-3,-40,153,93,2"),
        AdviceFiles(file=folder / "one.ngc", tools=tools, dry_run=True),
    )


def test_our_own_code_is_left_by_a_second_run(own: CodeAdvice, tmp_path: Path) -> None:
    code = own
    file = tmp_path / "again.ngc"
    file.write_bytes(code.rewritten.data)
    again = optimise_code(
        AdviceRequest(machine="vmc15", material="c45", stock="-3,-3,-40,153,93,2"),
        AdviceFiles(
            file=file, tools=BRACKET.parents[1] / "tools" / "bracket.toml", dry_run=True
        ),
    )
    assert again.rewritten.changed == 0
    assert again.rewritten.data == code.rewritten.data


THREADED = TURNED.replace(
    "M30\n", "T0404\nG97 S600 M3\nG0 X48. Z4.\nG32 Z-26. F1.5\nG0 X100.\nZ50.\nM30\n"
)


def test_a_thread_takes_its_lead_per_turn_and_keeps_it() -> None:
    found = advised(THREADED, LATHE)
    rapid = advised(THREADED.replace("G32 Z-26. F1.5", "G0 Z-26."), LATHE)
    # 30 mm at 1.5 mm per turn and 10 turns/s take 2 s.
    assert 1.5 < found.along.time_before - rapid.along.time_before < 2.1
    step = next(each for each in found.along.steps if each.name == "T4")
    assert step.before.duration == pytest.approx(step.after.duration)
    assert "G32 Z-26. F1.5\n" in found.rewritten.data.decode()
    assert not any("meets no stock" in each.message for each in found.findings)
