"""Result of ``score``: scores on measured runs, and the diagnosis of the residuals."""

from dataclasses import asdict, dataclass

from extras.learning.drift import Drift
from extras.learning.models import LearnedModel
from extras.learning.scores import Score, ScoredModel, model_name, score_columns
from extras.learning.table import unit_of
from service.errors import LIMIT_EXCEEDED, OK
from service.rendering.view import Fact, ResultView, Table, TextLine
from service.verbs.result import Result
from stepnc_model.plurals import counted


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ScoreResult(Result):
    """Scores of a model on measured runs."""

    model: LearnedModel
    rows: tuple[int, ...]
    """Numbers of the runs in their table, from 1; those outside the trained box are not in."""
    left_out: tuple[tuple[int, str], ...]
    """Numbers of runs outside the trained box, with the reasons."""
    scored: tuple[ScoredModel, ...]
    """The model first, then what is simpler."""
    drift: Drift

    @property
    def exit_code(self) -> int:
        """5 if there is an alarm, which is an exceeded bound."""
        return OK if self.drift.alarm is None else LIMIT_EXCEEDED

    def view(self) -> ResultView:
        """Return the scores, and the diagnosis."""
        model, drift, rows = self.model, self.drift, self.rows
        left = (
            f"left out: {counted(len(self.left_out), 'run')}, first row {row}: {text}"
            for row, text in self.left_out[:1]
        )
        return ResultView([
            TextLine(text=f"{model_name(model)}: {len(rows)} measured runs"),
            Fact(key="model", value=model.kind.value),
            Fact(key="target", value=model.target),
            Fact(key="physics", value=model.physics or None),
            Fact(key="runs", value=len(rows)),
            *(TextLine(text=text) for text in left),
            Fact(
                key="left_out",
                value=[{"row": row, "reason": text} for row, text in self.left_out],
            ),
            Table(columns=score_columns(unit_of(model.target)), rows=self.scored),
            Fact(key="scores", value={each.name: asdict(each.scores) for each in self.scored}),
            *(TextLine(text=line) for line in drift_lines(self)),
            Fact(
                key="drift",
                value={
                    "is_alarm": drift.alarm is not None,
                    **asdict(drift),
                    "alarm": None if drift.alarm is None else rows[drift.alarm],
                    "since": rows[drift.since],
                },
            ),
            TextLine(text="in brackets: 95 % interval by bootstrap of the runs"),
        ])


def drift_lines(result: ScoreResult) -> list[str]:
    """Diagnosis of the residuals, with its evidence."""
    drift, rows = result.drift, result.rows
    rate = f"{100.0 * drift.false_alarm:g} % false alarms"
    sums = f"sum {drift.statistic:.3g}, bound {drift.bound:.3g} ({rate})"
    if drift.alarm is None:
        lines = [f"no drift: {sums}"]
    else:
        lines = [f"drift: {sums}, exceeded at row {rows[drift.alarm]}"]
        since = f"measured over predicted since row {rows[drift.since]}: "
        before = "" if drift.before is None else f"; before: {_share(drift.before)}"
        lines.append(since + _share(drift.after) + before)
    lines.append(
        f"the test of the model left {100.0 * drift.expected:+.2f} %, standard deviation "
        f"{100.0 * drift.spread:.2g} %"
    )
    lines += [
        f"goes with {each.name}: correlation {each.correlation:+.2f}, "
        f"{100.0 * each.change:+.3g} % from least to greatest (chance {each.chance:.2g})"
        for each in drift.associations
    ]
    if not drift.associations:
        lines.append("goes with no setting and not with the order of the runs")
    return lines


def _share(score: Score) -> str:
    low, high = 100.0 * score.low, 100.0 * score.high
    return f"{100.0 * score.value:+.2f} % ({low:+.2f} to {high:+.2f})"
