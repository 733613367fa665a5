"""Feeds along the paths of NC code as text, JSON, tables and one self-contained page."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from service.along_path.output import STEP, along_path_items, along_path_record
from service.along_path.run import FeedsAlongPath
from service.exit_codes import LIMIT_EXCEEDED, NOTHING_ADVISED, OK
from service.rendering.text import RED
from service.rendering.view import Fact, Findings, ResultView, TextLine
from service.verbs.optimise.result import OptimiseResult
from simulator.spec import Machine, MaterialMatch
from stepnc_model.errors import Finding
from stepnc_model.nc.advice import RewrittenCode

if TYPE_CHECKING:
    import plotly.graph_objects as go


@dataclass(frozen=True, slots=True, kw_only=True)
class CodeAdvice(OptimiseResult):
    """Feeds along the paths of NC code, and the rewritten code."""

    program: str
    machine: Machine
    material: MaterialMatch
    control: str
    frame: str
    """Frame in which the stock stands."""
    along: FeedsAlongPath
    rewritten: RewrittenCode
    findings: tuple[Finding, ...]
    faults: tuple[Finding, ...] = ()
    """Rapids through material, overloads, and bounds that the written code breaks."""

    @property
    def time_before(self) -> float:
        """Time of the code as given, s."""
        return self.along.time_before

    @property
    def time_after(self) -> float:
        """Time of the advised code, s."""
        return self.along.time_after

    @property
    def exit_code(self) -> int:
        """Exit code: faults first, then whether anything was advised."""
        if self.faults:
            return LIMIT_EXCEEDED
        return OK if self.is_advised else NOTHING_ADVISED

    def view(self) -> ResultView:
        """Return faults, the comparison of both runs, what was changed, and the findings."""
        rewritten = self.rewritten
        return ResultView([
            *(TextLine(text=str(fault), colour=RED) for fault in self.faults),
            TextLine(
                text=f"{self.program}: control {self.control}, machine {self.machine.name} "
                f"({self.machine.title}), material {self.material.material.title}; the stock "
                f"stands in {self.frame}"
            ),
            Fact(key="program", value=self.program),
            Fact(key="control", value=self.control),
            Fact(key="machine", value=self.machine.name),
            Fact(key="material", value=self.material.material.name),
            Fact(key="frame", value=self.frame),
            Fact(key="along_path", value=along_path_record(self.along)),
            *along_path_items(self.along),
            TextLine(
                text=f"{rewritten.changed} blocks changed, {rewritten.added} added by "
                f"splitting, {rewritten.restored} got the programmed feed back, "
                f"{len(rewritten.unchanged)} not as advised"
            ),
            Fact(
                key="blocks",
                value={
                    "changed": rewritten.changed,
                    "added": rewritten.added,
                    "restored": rewritten.restored,
                    "unchanged": [
                        {
                            "line": each.line,
                            "reason": each.reason,
                            "is_unsplit": each.is_unsplit,
                        }
                        for each in rewritten.unchanged
                    ],
                },
            ),
            Findings(found=self.findings, told=self.faults),
        ])

    def figures(self) -> "list[go.Figure]":
        """Return feed, force and power along the paths."""
        from service.along_path.figures import along_path_figures  # noqa: PLC0415 (plotly)

        return list(along_path_figures(self.along))

    def page(self) -> str:
        """Return the HTML report."""
        from service.rendering.pages import plot, rendered  # noqa: PLC0415 (Jinja)

        return rendered(
            "code.html.jinja",
            code=self,
            columns=STEP,
            plots=[plot(each, f"along{row}") for row, each in enumerate(self.figures())],
        )
