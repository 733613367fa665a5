"""``blocktest``: NC code for a machine, and what it leaves out."""

import logging
from pathlib import Path
from typing import Any

import pytest

import stepnc
from extras.calibration.model.block_feed import circles_of
from stepnc_model.errors import StepNcError
from stepnc_model.nc.exact_reading import read_blocks
from stepnc_model.post.dialect import Dialect
from tests.every_case import every_case


def test_paper_s_circles_are_written(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    output = tmp_path / "test.ngc"
    with caplog.at_level(logging.INFO, logger="stepnc"):
        written = stepnc.blocktest(output=output, machine="vmc15", lines=50)
    circles = circles_of(read_blocks(output.read_text().splitlines(), Dialect.LINUXCNC))
    assert len(circles) == 27
    assert written.left_out == ()
    assert circles[0].spacing == pytest.approx(0.00254, rel=0.01)
    assert circles[-1].radius == pytest.approx(50.8, rel=1e-4)
    assert circles[0].feed * 60.0 == pytest.approx(20_000.0)
    assert caplog.messages[-1].startswith(f"written: {output} (")


def test_coarse_controls_leave_fine_spacings_out_and_say_so(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    with caplog.at_level(logging.INFO, logger="stepnc"):
        written = stepnc.blocktest(output=tmp_path / "test.mpf", machine="vmc15", lines=50)
    assert len(written.left_out) == 4
    assert caplog.messages[0] == (
        "left out: spacing 2.54 µm: sinumerik writes steps of 1 µm, "
        "and 20 of them are the least"
    )


def test_lists_units_and_feed_are_options(tmp_path: Path) -> None:
    output = tmp_path / "test.nc"
    result = stepnc.blocktest(
        output=output, machine="lathe22", unit="mm", spacing=(0.2, 0.05), radius=10.0,
        feed=3000.0, lines=60, dialect="haas",
    )  # fmt: skip
    test = result.test
    assert (test.spacings, test.radii, test.feed) == ((0.05, 0.2), (10.0,), 50.0)
    assert "G18" in output.read_text()


@every_case(
    ("words", "name", "message"),
    [
        ({}, "a.ngc", "--machine"),
        ({"machine": "vmc15"}, "a.txt", "unknown file extension"),
        ({"machine": "vmc15", "spacing": (-1.0,)}, "a.ngc", "spacing -1 in: must be"),
        ({"machine": "vmc15", "spacing": (0.4,)}, "a.ngc", "at most half"),
        ({"machine": "vmc15", "radius": (50.0,)}, "a.ngc", "at most 39.3701 in"),
        ({"machine": "vmc15", "spacing": (0.0001,)}, "a.nc", "no spacing is left"),
        ({"machine": "vmc15", "feed": 0.0}, "a.ngc", "feed 0: it must be"),
        ({"machine": "paper002"}, "a.ngc", "--feed"),
    ],
)
def test_what_cannot_be_written_is_told(
    tmp_path: Path, words: dict[str, Any], name: str, message: str
) -> None:
    with pytest.raises(StepNcError, match=message):
        stepnc.blocktest(output=tmp_path / name, **words)
    assert not list(tmp_path.iterdir())


def test_result_lists_the_circles(tmp_path: Path) -> None:
    result = stepnc.blocktest(
        output=tmp_path / "a.ngc",
        machine="vmc15",
        unit="mm",
        spacing=(0.1, 0.2),
        radius=(20.0, 30.0),
    )
    assert result.table("circles").to_pydict() == {
        "radius_mm": [20.0, 20.0, 30.0, 30.0],
        "spacing_mm": [0.1, 0.2, 0.1, 0.2],
    }
    assert result.record()["lines"] == len((tmp_path / "a.ngc").read_text().splitlines())
