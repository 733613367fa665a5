"""Cuts of the sample parts along their paths, held against the paths and the stock."""

from dataclasses import replace
from math import pi, radians, sin
from pathlib import Path

import pytest

from optimiser.cuts.cut import Cut
from optimiser.cuts.feature_cuts import estimated_cut
from optimiser.cuts.path_cuts import MeasuredCuts
from simulator.library import load_machine, load_material
from simulator.removal.engage import MillingStock
from simulator.removal.lathe import TurningStock
from simulator.spec import Kienzle
from stepnc_model.errors import PathError
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program, ResolvedWorkingstep
from stepnc_model.toolpath.arc import length
from stepnc_model.toolpath.generate import workingstep_path

PARTS = Path(__file__).parents[3] / "examples" / "parts"
STEEL = replace(load_material("c45"), kienzle=Kienzle(k_c11=1500.0, m_c=0.25))


def program(part: str, *change: str) -> Program:
    text = (PARTS / f"{part}.stpnc").read_text()
    if change:
        assert change[0] in text
        text = text.replace(change[0], change[1])
    return Program(Part21File.from_bytes(text.encode(), name=part), name=part)


def cuts_of(part: str, machine: str, *change: str) -> tuple[MeasuredCuts, dict[str, Cut]]:
    """All workingsteps as programmed, but threads."""
    read = program(part, *change)
    source = MeasuredCuts(read, load_machine(machine), STEEL)
    found = {}
    for step in read.workingsteps:
        if "thread" in step.operation_type:
            source.leave_out(step)
        else:
            found[step.id], _ = source.cut(step)
    return source, found


def step_of(read: Program, name: str) -> ResolvedWorkingstep:
    (found,) = (step for step in read.workingsteps if step.id == name)
    return found


@pytest.fixture(scope="module")
def bracket() -> tuple[MeasuredCuts, dict[str, Cut]]:
    return cuts_of("bracket", "vmc15")


@pytest.fixture(scope="module")
def shaft() -> tuple[MeasuredCuts, dict[str, Cut]]:
    return cuts_of("shaft", "lathe22")


def test_what_the_workingsteps_remove_is_what_the_stock_lost(
    bracket: tuple[MeasuredCuts, dict[str, Cut]],
) -> None:
    source, cuts = bracket
    stock = source.stocks.before(source.program.workingsteps[-1])
    assert isinstance(stock, MillingStock)
    lost = 156.0 * 96.0 * 42.0 - stock.map.volume
    # Sections know walls better than the map, which loses whole cells: half a cell of 0.12 mm
    # along walls of some 60 cm².
    assert sum(cut.volume or 0.0 for cut in cuts.values()) == pytest.approx(lost, rel=4e-3)


def test_what_turning_removes_is_what_the_bar_lost(
    shaft: tuple[MeasuredCuts, dict[str, Cut]],
) -> None:
    source, cuts = shaft
    bar = source.stocks.before(source.program.workingsteps[-1])
    assert isinstance(bar, TurningStock)
    lost = pi * 30.0**2 * 152.0 - bar.volume
    assert sum(cut.volume or 0.0 for cut in cuts.values()) == pytest.approx(lost, rel=2e-3)


def test_length_is_that_of_the_moves_at_the_programmed_feed(
    bracket: tuple[MeasuredCuts, dict[str, Cut]],
) -> None:
    source, cuts = bracket
    for name in ("ROUGH FACE", "FINISH CONTOUR", "MILL SLOT"):
        step = step_of(source.program, name)
        path = workingstep_path(source.program, step)
        fed = sum(length(at, move) for at, move in path.segments() if move.feed is not None)
        cut = cuts[name]
        assert cut.length * cut.programmed.passes == pytest.approx(fed)
        assert cut.link_length == 0.0
        assert cut.rest_time > 0.0


def test_mean_load_makes_the_energy_of_the_volume(
    bracket: tuple[MeasuredCuts, dict[str, Cut]],
) -> None:
    """With a constant specific force the mean load times length is the volume removed."""
    even = replace(STEEL, kienzle=Kienzle(k_c11=1000.0, m_c=0.0))
    source = MeasuredCuts(bracket[0].program, load_machine("vmc15"), even)
    for step in source.program.workingsteps[:6]:
        cut, _ = source.cut(step)
        assert cut.engagement is not None
        depth = cut.total_depth / cut.programmed.passes
        width = 0.5 * cut.diameter * cut.engagement.cosine_difference
        greatest = depth * cut.depth_share * width
        swept = cut.load_share * greatest * cut.length * cut.programmed.passes
        assert swept == pytest.approx(cut.volume)


def test_a_slot_is_full_and_a_wall_is_thin(
    bracket: tuple[MeasuredCuts, dict[str, Cut]],
) -> None:
    cuts = bracket[1]
    assert cuts["MILL SLOT"].radial_width == pytest.approx(12.0, rel=0.01)
    # Its hardest place goes down a ramp: the end cuts too, as if the flank went deeper.
    pocket = cuts["ROUGH POCKET"]
    assert pocket.depth_share * pocket.radial_width > 12.0
    assert pocket.radial_width > 11.0
    assert cuts["FINISH CONTOUR"].radial_width < 1.0


def test_a_reamer_finds_the_hole_of_the_drill(
    bracket: tuple[MeasuredCuts, dict[str, Cut]],
) -> None:
    cuts = bracket[1]
    assert cuts["DRILL HOLE 1"].previous_diameter == 0.0
    assert cuts["REAM HOLE 1"].previous_diameter == 9.8


def test_turning_is_told_where_the_workpiece_is_widest(
    shaft: tuple[MeasuredCuts, dict[str, Cut]],
) -> None:
    """The first pass takes 2 mm off a bar of 60 mm; 150 m/min are 2500 mm/s."""
    cut = shaft[1]["ROUGH CONTOUR"]
    assert cut.diameter == pytest.approx(60.0)
    assert pi * cut.diameter * cut.programmed.speed == pytest.approx(2500.0)
    assert 1.0 <= cut.depth_share < 1.2


def test_open_pockets_are_entered_straight_down_and_nothing_else_is(
    bracket: tuple[MeasuredCuts, dict[str, Cut]],
) -> None:
    """PLUNGE_TOOLAXIS inside the stock; faces, steps and slots begin beside it."""
    ways = {name: cut.way_in for name, cut in bracket[1].items() if cut.way_in is not None}
    straight = {name for name, way in ways.items() if way.drilled}
    assert straight == {"ROUGH OPEN POCKET", "FINISH OPEN POCKET"}
    assert all(ways[name].reaches_axis and ways[name].ramp is None for name in straight)
    assert {name for name, way in ways.items() if way.ramp} == {"ROUGH POCKET", "FINISH POCKET"}
    assert ways["ROUGH POCKET"].sine == pytest.approx(sin(radians(3.0)))
    assert all(cut.plunge is None for cut in bracket[1].values())


def test_a_plunge_is_told_by_what_is_left_there(
    bracket: tuple[MeasuredCuts, dict[str, Cut]],
) -> None:
    """The open side of the pocket: half of the tool hangs in the air."""
    way = bracket[1]["ROUGH OPEN POCKET"].way_in
    assert way is not None
    for drilled in way.drilled:
        assert drilled.previous_diameter == 0.0
        assert drilled.fill == pytest.approx(0.5, abs=0.02)


def test_the_same_setting_is_told_alike_each_time(
    bracket: tuple[MeasuredCuts, dict[str, Cut]],
) -> None:
    read = bracket[0].program
    source = MeasuredCuts(read, load_machine("vmc15"), STEEL)
    step = read.workingsteps[0]
    cut, _ = source.cut(step)
    double = replace(cut.programmed, feed=2.0 * cut.programmed.feed)
    once = source.at(step, cut, double)
    assert source.at(step, cut, cut.programmed) == cut
    assert source.at(step, cut, double) == once


def test_a_faster_feed_shortens_the_time_but_not_the_rest(
    bracket: tuple[MeasuredCuts, dict[str, Cut]],
) -> None:
    read = bracket[0].program
    source = MeasuredCuts(read, load_machine("vmc15"), STEEL)
    step = read.workingsteps[0]
    cut, _ = source.cut(step)
    double = source.at(step, cut, replace(cut.programmed, feed=2.0 * cut.programmed.feed))
    assert double.length == pytest.approx(cut.length)
    assert double.rest_time == pytest.approx(cut.rest_time, rel=0.2)
    assert double.programmed == cut.programmed


def test_fewer_passes_have_a_path_of_their_own(
    bracket: tuple[MeasuredCuts, dict[str, Cut]],
) -> None:
    """A slot of 6 mm in one pass: one way instead of two, and the whole depth in one."""
    read = bracket[0].program
    source = MeasuredCuts(read, load_machine("vmc15"), STEEL)
    step = step_of(read, "MILL SLOT")
    for earlier in read.workingsteps[: step.index]:
        source.leave_out(earlier)
    cut, _ = source.cut(step)
    one = source.at(step, cut, replace(cut.programmed, passes=1, depth=6.0))
    assert one.length == pytest.approx(cut.length, rel=0.25)
    assert one.volume == pytest.approx(cut.volume, rel=1e-3)
    assert one.radial_width == pytest.approx(12.0, rel=0.01)
    assert one.programmed == cut.programmed


def test_a_path_of_the_file_has_no_other_depth() -> None:
    """Drilling knows no passes: all are alike."""
    read = program("bracket")
    source = MeasuredCuts(read, load_machine("vmc15"), STEEL)
    step = step_of(read, "DRILL HOLE 1")
    cut, _ = source.cut(step)
    other = source.at(step, cut, replace(cut.programmed, passes=2, depth=20.0))
    assert other.length == pytest.approx(cut.length)


def test_a_workingstep_without_a_path_has_no_cut() -> None:
    """No run could follow advice on it."""
    read = program("bracket", "'ROUGH POCKET',10.,$,#420", "'ROUGH POCKET',-10.,$,#420")
    source = MeasuredCuts(read, load_machine("vmc15"), STEEL)
    with pytest.raises(PathError, match="the retract plane must lie above the feature"):
        source.cut(step_of(read, "ROUGH POCKET"))


def test_a_workingstep_that_is_left_out_without_a_path_is_remembered() -> None:
    read = program("bracket", "'ROUGH POCKET',10.,$,#420", "'ROUGH POCKET',-10.,$,#420")
    source = MeasuredCuts(read, load_machine("vmc15"), STEEL)
    source.leave_out(step_of(read, "ROUGH POCKET"))
    with pytest.raises(PathError, match="the feature is not ready"):
        source.cut(step_of(read, "FINISH POCKET"))


NOT_DRILLED = ("(#20,#21,#22,#23,#24,#25),$,$,$);", "(#24),$,$,$);")


def test_a_hole_that_nobody_drilled_is_not_there() -> None:
    """The reaming says 9.8 mm; the map knows better."""
    read = program("bracket", *NOT_DRILLED)
    step = step_of(read, "REAM HOLE 1")
    assert estimated_cut(read, step, load_machine("vmc15"), STEEL)[0].previous_diameter == 9.8
    cut, _ = MeasuredCuts(read, load_machine("vmc15"), STEEL).cut(step)
    assert cut.previous_diameter < 1.0


def test_what_an_estimate_guesses_is_not_said_where_it_is_known() -> None:
    text = (PARTS / "bracket.stpnc").read_text().replace(*NOT_DRILLED)
    text = text.replace("#330,3.,$,9.8,$,1.", "#330,3.,$,$,$,1.")
    read = Program(Part21File.from_bytes(text.encode(), name="bracket"), name="bracket")
    step = step_of(read, "REAM HOLE 1")
    guess = "cutting into solid material assumed"
    assert any(
        guess in each.message
        for each in estimated_cut(read, step, load_machine("vmc15"), STEEL)[1]
    )
    _, findings = MeasuredCuts(read, load_machine("vmc15"), STEEL).cut(step)
    assert not any(guess in each.message for each in findings)
