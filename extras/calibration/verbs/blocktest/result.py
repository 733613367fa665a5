"""Result of ``blocktest``: the circles of the test program that was written."""

from dataclasses import dataclass
from itertools import product
from pathlib import Path

from extras.calibration.model.block_feed import BlockTest
from service.rendering.columns import Column
from service.rendering.view import Fact, ResultView, Table
from service.verbs.result import Result
from stepnc_model.units import mm_min_from_speed

Circle = tuple[float, float]
"""Radius and spacing of a circle, mm."""

CIRCLES: tuple[Column[Circle], ...] = (
    Column(key="radius_mm", heading="radius mm", form=".2f", value=lambda circle: circle[0]),
    Column(key="spacing_mm", heading="spacing mm", form=".5f", value=lambda circle: circle[1]),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class BlockTestResult(Result):
    """Result of ``blocktest``."""

    file: Path
    test: BlockTest
    left_out: tuple[float, ...]
    """Spacings that the control cannot write evenly, mm."""
    lines: int
    """Number of lines of the file."""
    duration: float | None
    """Time of the program by the machine's block time, s; None without one."""

    def view(self) -> ResultView:
        """Return the circles for programs; people were told what was written."""
        return ResultView([
            Fact(key="file", value=str(self.file)),
            Fact(key="lines", value=self.lines),
            Fact(key="feed_mm_min", value=mm_min_from_speed(self.test.feed)),
            Fact(key="duration_s", value=self.duration),
            Table(
                key="circles", columns=CIRCLES, is_shown=False,
                rows=list(product(self.test.radii, self.test.spacings)),
            ),
            Fact(key="left_out_mm", value=self.left_out),
        ])  # fmt: skip
