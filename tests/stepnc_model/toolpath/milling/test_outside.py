"""Outside profiles, bosses and steps as flanks, and the passes beside them."""

from math import hypot, pi, radians, tan
from pathlib import Path

import pytest

from stepnc_model.errors import PathError
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.milling.contour import area, chain_length
from stepnc_model.toolpath.milling.cover import Flank
from stepnc_model.toolpath.milling.shapes import shapes
from stepnc_model.toolpath.task import ToolPathTask, job_of

PARTS = Path(__file__).parents[4] / "examples" / "parts"
END = "ENDSEC;\nEND-ISO-10303-21;"


def edited(*changes: tuple[str, str], more: str = "") -> Program:
    """The bracket with some texts replaced and instances added."""
    text = (PARTS / "bracket.stpnc").read_text(encoding="utf-8")
    for before, after in (*changes, (END, f"{more}\n{END}")):
        assert before in text, before
        text = text.replace(before, after)
    return Program(Part21File.from_bytes(text.encode(), name="bracket"))


def job_at(id: str, *changes: tuple[str, str], more: str = "") -> ToolPathTask:
    """Job of the workingstep with a name."""
    program = edited(*changes, more=more)
    step = next(step for step in program.workingsteps if step.id == id)
    return job_of(program, step)


def flank(id: str, *changes: tuple[str, str], more: str = "") -> Flank:
    job = job_at(id, *changes, more=more)
    (ref,) = job.step.features
    (found,) = shapes(job, ref, job.frame(ref))
    assert isinstance(found, Flank)
    return found


def test_contour_has_its_free_side_outside() -> None:
    """150 x 90 mm with corners of 10 mm, the part on the right of the way."""
    found = flank("ROUGH CONTOUR")
    assert area(found.chain) == pytest.approx(-(150.0 * 90.0 - (4.0 - pi) * 100.0))
    assert (found.is_closed, found.top, found.bottom) == (True, 0.0, -20.0)


def test_step_reaches_from_its_edge_to_the_side_of_the_stock_on_its_right() -> None:
    """The edge runs along y at x = 138 mm, the stock ends at 153 mm."""
    found = flank("MILL STEP")
    assert found.width == pytest.approx(15.0)
    (edge,) = found.chain
    assert edge.start + 1j * edge.along(0.0) == pytest.approx(139 + 90j)


def test_step_along_the_other_sense_lies_on_the_other_side() -> None:
    found = flank(
        "MILL STEP", ("#126=LINEAR_PATH($,#127,#503)", "#126=LINEAR_PATH($,#127,#504)")
    )
    assert found.width == pytest.approx(138.0 + 3.0)


def test_step_without_stock_has_no_known_width() -> None:
    assert flank("MILL STEP", ("0.05,$,$,#33,", "0.05,$,$,$,")).width is None


def test_boss_that_leans_widens_below() -> None:
    changes = (
        ("'ROUGH POCKET',#43,#140", "'ROUGH POCKET',#43,#190"),
        ("#141,#143,#191,$);", "#141,#143,#191,5.);"),
    )
    found = flank("ROUGH POCKET", *changes)
    assert area(found.chain) == pytest.approx(-64.0 * pi)
    assert found.inset(0.0) == pytest.approx(12.0 * tan(radians(5.0)))


def test_outline_that_crosses_itself_is_refused() -> None:
    more = "#900=GENERAL_CLOSED_PROFILE($,#901);#901=POLYLINE('',(#500,#182,#183,#181,#500));"
    with pytest.raises(
        PathError, match="#110 GENERAL_OUTSIDE_PROFILE: the feature's boundary crosses"
    ):
        flank("ROUGH CONTOUR", ("#111,#114,#116);", "#111,#114,#900);"), more=more)


def test_open_outline_has_the_part_on_its_left() -> None:
    more = "#900=GENERAL_PROFILE($,#158);"
    found = flank("ROUGH CONTOUR", ("#111,#114,#116);", "#111,#114,#900);"), more=more)
    assert not found.is_closed
    assert chain_length(found.chain) == pytest.approx(40.0 + 28.0 + 40.0)
    assert found.chain[0].start == pytest.approx(28 + 0j)
    assert hypot(found.chain[-1].end.real, found.chain[-1].end.imag) == pytest.approx(0.0)
