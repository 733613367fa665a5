"""A tool path while it is being made: running state, one object for one workingstep."""

from stepnc_model.entities.entity import Entity
from stepnc_model.errors import Finding
from stepnc_model.part21.values import Ref
from stepnc_model.toolpath.job import Job
from stepnc_model.toolpath.path import (
    Arc,
    Cycle,
    Dwell,
    Feed,
    Move,
    MoveType,
    Plane,
    Point,
    SpindleCommand,
    Step,
    ToolPath,
)

SAME = 1e-9
"""mm; a move shorter than this is none"""


class Course:
    """Collects the steps of a path; knows where the tool is."""

    def __init__(self, job: Job, start: Point, *, is_turning: bool = False) -> None:
        self._job = job
        self._start = start
        self._is_turning = is_turning
        self._steps: list[Step] = []
        self._cycles: list[Cycle] = []
        self._findings: list[Finding] = list(job.findings)
        self._plunge_feed = job.plunge_feed
        self.at = start
        """where the tool is"""

    @property
    def count(self) -> int:
        """Steps so far: the index of the next one."""
        return len(self._steps)

    def rapid(self, end: Point, type: MoveType = MoveType.RAPID) -> None:
        """Straight, in rapid."""
        self.add(Move(end=end, type=type))

    def descend(self, end: Point, type: MoveType = MoveType.RAPID) -> None:
        """Straight down: in rapid as far as no stock can stand, at the feed from there on."""
        x, y, z = end
        safe_z = min(self._job.rapid_z(end), self.at[2])
        self.rapid((x, y, max(safe_z, z)), type)
        self.line(end, MoveType.NO_CONTACT)

    def line(self, end: Point, type: MoveType, feed: Feed | None = None) -> None:
        """Straight, at the programmed feed or at another one."""
        self.add(Move(end=end, type=type, feed=feed or self._feed(end, type)))

    def arc(
        self,
        end: Point,
        type: MoveType,
        *,
        centre: Point,
        turn: float,
        plane: Plane = Plane.XY,
    ) -> None:
        """About a centre, at the programmed feed."""
        arc = Arc(centre=centre, turn=turn, plane=plane)
        self.add(Move(end=end, type=type, feed=self._feed(end, type), arc=arc))

    def _feed(self, end: Point, type: MoveType) -> Feed:
        """The programmed feed, or that of an approach that goes down: a plunge or a ramp."""
        is_plunge = type is MoveType.APPROACH and end[2] < self.at[2] - SAME
        return self._plunge_feed if is_plunge else self._job.feed

    def add(self, move: Move) -> None:
        """Append a move, unless it leads nowhere."""
        if move.arc is None and _is_same(self.at, move.end):
            return
        self._steps.append(move)
        self.at = move.end

    def dwell(self, *, seconds: float | None = None, revolutions: float | None = None) -> None:
        """Pause."""
        self._steps.append(Dwell(seconds=seconds, revolutions=revolutions))

    def spindle(self, command: SpindleCommand) -> None:
        """Stop, start or reverse the spindle."""
        self._steps.append(command)

    def cycle(self, cycle: Cycle) -> None:
        """Say that a run of steps is a cycle that controls have."""
        self._cycles.append(cycle)

    def find(self, finding: Finding) -> None:
        """Say what was assumed, once."""
        if finding not in self._findings:
            self._findings.append(finding)

    def warn(self, message: str, ref: Ref[Entity], attribute: str = "") -> None:
        """Say what a machinist would want to see, once."""
        self.find(self._job.warning(message, ref, attribute))

    def finished(self) -> ToolPath:
        """The path."""
        step = self._job.step
        return ToolPath(
            workingstep=step.ref,
            id=step.id,
            operation_ref=step.operation_ref,
            tool_ref=step.tool_ref,
            technology_ref=step.technology_ref,
            functions_ref=step.functions_ref,
            is_turning=self._is_turning,
            start=self._start,
            steps=tuple(self._steps),
            cycles=tuple(self._cycles),
            findings=tuple(self._findings),
        )


def _is_same(one: Point, other: Point) -> bool:
    return (
        abs(one[0] - other[0]) < SAME
        and abs(one[1] - other[1]) < SAME
        and abs(one[2] - other[2]) < SAME
    )
