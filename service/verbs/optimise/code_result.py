"""Feeds along the paths of NC code as text, JSON, tables and one self-contained page."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from service.along_path.output import STEP, along_path_items, along_path_record
from service.along_path.run import FeedsAlongPath
from service.errors import LIMIT_EXCEEDED, NOTHING_ADVISED, OK
from service.rendering.columns import Column, records
from service.rendering.text import RED
from service.rendering.view import Fact, Findings, ResultView, TextLine
from service.verbs.optimise.result import OptimiseResult
from simulator.spec import Machine, MaterialMatch
from stepnc_model.errors import Finding
from stepnc_model.nc.advice import RewrittenCode
from stepnc_model.plurals import counted

if TYPE_CHECKING:
    import plotly.graph_objects as go

    from optimiser.along_path.deep_places import DeepPlaces


DEPTH_RISKS: "tuple[Column[tuple[str, DeepPlaces]], ...]" = (
    Column(key="id", value=lambda pair: pair[0]),
    Column(key="line", value=lambda pair: pair[1].block),
    Column(key="depth_mm", value=lambda pair: pair[1].load.value),
    Column(key="bound_mm", value=lambda pair: pair[1].load.bound),
    Column(key="width_mm", value=lambda pair: pair[1].width),
    Column(key="length_mm", value=lambda pair: pair[1].length),
)
"""Columns of the places where a mill cuts deeper than its tool allows."""


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
    def name(self) -> str:
        """Name of the program."""
        return self.program

    @property
    def time_before(self) -> float:
        """Time of the code as given, s."""
        return self.along.time_before

    @property
    def time_after(self) -> float:
        """Time of the advised code, s."""
        return self.along.time_after

    @property
    def unchecked(self) -> str:
        """State which tools cut deeper than they may; empty if none does."""
        return f"; too deep in {', '.join(self.along.deep)}" if self.along.deep else ""

    @property
    def exit_code(self) -> int:
        """Exit code: faults first, then whether anything was advised."""
        if self.faults:
            return LIMIT_EXCEEDED
        return OK if self.is_advised else NOTHING_ADVISED

    def view(self) -> ResultView:
        """Return faults, why it is slower, both runs, what was changed, and the findings."""
        rewritten, slower = self.rewritten, self.along.slower_than_programmed
        return ResultView([
            *(TextLine(text=str(fault), colour=RED) for fault in self.faults),
            *(TextLine(text=text, colour=RED) for text in slower),
            TextLine(
                text=f"{self.program}: control {self.control}, machine {self.machine.name} "
                f"({self.machine.title}), material {self.material.material.title}; the stock "
                f"stands in {self.frame}{self.unchecked}",
                colour=RED if self.along.deep else "",
            ),
            Fact(key="program", value=self.program),
            Fact(key="control", value=self.control),
            Fact(key="machine", value=self.machine.name),
            Fact(key="material", value=self.material.material.name),
            Fact(key="frame", value=self.frame),
            Fact(key="is_checked", value=not self.along.deep),
            Fact(key="depth_risks", value=records(DEPTH_RISKS, list(self.along.deep.items()))),
            Fact(key="slower_than_programmed", value=list(slower)),
            Fact(key="along_path", value=along_path_record(self.along)),
            *along_path_items(self.along),
            TextLine(
                text=f"{counted(rewritten.changed, 'block')} changed, {rewritten.added} added "
                f"by splitting, {rewritten.restored} got the programmed feed back, "
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
            Findings(findings=self.findings, reported=self.faults),
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
