"""Feeds along the depth of a hole, on the drill of the sample bracket.

Its point is 1.7835 mm long; the full diameter goes 43 mm deep.
"""

from math import radians, tan
from pathlib import Path

import pytest

from stepnc_model.entities.milling import DrillingTypeOperation
from stepnc_model.errors import PathError
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.hole.cycle import FeedStage, retract_feed, stages_of
from stepnc_model.toolpath.hole.feature import depth_of, holes_of
from stepnc_model.toolpath.path import Feed
from stepnc_model.toolpath.task import ToolPathTask, job_of
from tests.every_case import every_case

BRACKET = Path(__file__).parents[4] / "examples" / "parts" / "bracket.stpnc"
POINT = 4.9 * tan(radians(20.0))
STRATEGY = "#361=DRILLING_TYPE_STRATEGY($,0.5,2.,$,0.6,36.);"
OPERATION = "#212=DRILLING($,$,'DRILL HOLE 1',5.,$,#450,#311,#330,3.,$,$,$,$,#361);"


def read(*changes: tuple[str, str]) -> tuple[ToolPathTask, DrillingTypeOperation]:
    text = BRACKET.read_text(encoding="utf-8")
    for before, after in changes:
        assert before in text, before
        text = text.replace(before, after)
    program = Program(Part21File.from_bytes(text.encode(), name="bracket"))
    (step,) = (step for step in program.workingsteps if step.id == "DRILL HOLE 1")
    assert isinstance(step.operation, DrillingTypeOperation)
    return job_of(program, step), step.operation


def stages(*changes: tuple[str, str]) -> tuple[FeedStage, ...]:
    job, operation = read(*changes)
    (hole,) = holes_of(job, operation)
    return stages_of(job, operation, hole, depth_of(job, operation, hole))


def strategy(numbers: str) -> tuple[str, str]:
    return STRATEGY, f"#361=DRILLING_TYPE_STRATEGY({numbers});"


def table(found: tuple[FeedStage, ...]) -> list[tuple[object, float, float]]:
    """Depth of the full diameter, ratio of the feed, ratio of the speed."""
    return [(-stage.end_z - POINT, stage.feed.ratio, stage.feed.speed_ratio) for stage in found]


def test_without_strategy_one_feed_goes_all_the_way() -> None:
    found = stages((OPERATION, OPERATION.replace("#361", "$")))
    assert table(found) == [(pytest.approx(43.0), 1.0, 1.0)]


def test_an_empty_strategy_reduces_nothing() -> None:
    assert table(stages(strategy("$,$,$,$,$,$"))) == [(pytest.approx(43.0), 1.0, 1.0)]


def test_start_and_end_reduce_feed_and_speed() -> None:
    """Down to 2 mm, and from 36 mm on."""
    assert table(stages(strategy("0.8,0.5,2.,0.7,0.6,36."))) == [
        (pytest.approx(2.0), 0.5, 0.8),
        (pytest.approx(36.0), 1.0, 1.0),
        (pytest.approx(43.0), 0.6, 0.7),
    ]


def test_percent_of_older_files_are_ratios() -> None:
    """ISO 14649-11, example 1, in its version of 2002."""
    assert stages(strategy("75.,50.,2.,50.,75.,8.")) == stages(
        strategy("0.75,0.5,2.,0.5,0.75,8.")
    )


def test_an_end_before_the_start_begins_where_the_start_ends() -> None:
    assert table(stages(strategy("$,0.5,10.,$,0.6,4."))) == [
        (pytest.approx(10.0), 0.5, 1.0),
        (pytest.approx(43.0), 0.6, 1.0),
    ]


def test_a_start_deeper_than_the_hole_is_the_whole_hole() -> None:
    assert table(stages(strategy("$,0.5,99.,$,$,$"))) == [(pytest.approx(43.0), 0.5, 1.0)]


def test_reductions_without_a_depth_are_none() -> None:
    assert table(stages(strategy("$,0.5,$,$,0.5,$"))) == [(pytest.approx(43.0), 1.0, 1.0)]


@every_case("ratio", ["0.", "-0.5", "101."])
def test_what_is_no_ratio_is_refused(ratio: str) -> None:
    with pytest.raises(PathError, match=r"reduced_feed_at_start: .*a ratio from 0 to 1"):
        stages(strategy(f"$,{ratio},2.,$,$,$"))


def test_what_is_no_strategy_of_drilling_is_refused() -> None:
    with pytest.raises(PathError, match=r"#350 .*is not a drilling strategy"):
        stages((OPERATION, OPERATION.replace("#361", "#350")))


class TestTap:
    TAPPING = (OPERATION, OPERATION.replace("DRILLING", "TAPPING").replace(")", ",.F.)"))
    TECHNOLOGY = "#311=MILLING_TECHNOLOGY(0.0053,.TCP.,$,-38.,$,.F.,.F.,.F.,$);"

    @pytest.mark.parametrize(
        "technology",
        [
            "0.015,.TCP.,$,-10.,$,.T.,.F.,.F.,$",
            "$,.TCP.,$,-10.,0.75,.T.,.F.,.F.,$",
        ],
    )
    def test_it_advances_by_its_pitch_in_each_revolution(self, technology: str) -> None:
        """15 mm/s at 10 rev/s; 0.75 mm for each of two teeth."""
        (stage,) = stages(
            self.TAPPING, (self.TECHNOLOGY, f"#311=MILLING_TECHNOLOGY({technology});")
        )
        assert stage.feed.is_synchronised
        assert stage.feed.per_revolution == pytest.approx(1.5)

    def test_its_retract_keeps_the_pitch(self) -> None:
        job, operation = read((
            OPERATION,
            self.TAPPING[1].replace("$,$,$,$,#361", "$,$,$,2.,#361"),
        ))
        (hole,) = holes_of(job, operation)
        (stage,) = stages_of(job, operation, hole, depth_of(job, operation, hole))
        assert retract_feed(job, operation, stage.feed) == stage.feed


class TestRetract:
    LAST = Feed(technology=Ref(311), ratio=0.5, speed_ratio=0.7)

    def test_it_is_the_programmed_feed_at_the_speed_of_the_bottom(self) -> None:
        feed = retract_feed(*read(), self.LAST)
        assert (feed.ratio, feed.speed_ratio) == (1.0, 0.7)

    def test_feed_on_retract_is_a_ratio_of_it(self) -> None:
        changed = OPERATION.replace("$,$,$,$,#361", "$,$,$,2.5,#361")
        feed = retract_feed(*read((OPERATION, changed)), self.LAST)
        assert (feed.ratio, feed.speed_ratio) == (2.5, 0.7)

    @pytest.mark.parametrize("ratio", ["0.", "-1."])
    def test_it_must_be_positive(self, ratio: str) -> None:
        changed = OPERATION.replace("$,$,$,$,#361", f"$,$,$,{ratio},#361")
        with pytest.raises(PathError, match="feed_on_retract"):
            retract_feed(*read((OPERATION, changed)), self.LAST)
