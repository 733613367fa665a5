"""Cuts as the real tool path makes them, in the stock that is left, timed by the machine.

Each workingstep's path cuts the stock of its setup, which goes on to the next workingstep. From
what the tool meets come the hardest places, for the limits, and the mean load, for the energy;
from the motion of the axes comes the time. What lasts as the feed says counts as length: mm at
the feed programmed, own ratios and a spindle that follows the radius included. The rest counts
as time: ramps, rapids, moves with a feed of their own, waits.
"""

from dataclasses import dataclass, replace
from math import sqrt

from optimiser.cut import Cut, CutKind
from optimiser.estimated import estimated_cut
from optimiser.hardest import (
    Met,
    greatest_section,
    lengths,
    weighted_volume,
    with_hardest,
)
from optimiser.problem import Setting
from optimiser.shape import shape_of
from simulator.errors import SimulationError
from simulator.motion.segments import Bools
from simulator.motion.tool_path import LookUp, Pace, Run, duration, paced, run_of, usual_motion
from simulator.removal.cutter import Insert
from simulator.removal.engage import MillingStock
from simulator.removal.lathe import TurningStock
from simulator.removal.stations import CutKind as StationKind
from simulator.removal.zmap import MOST_CELLS
from simulator.spec import Kienzle, Machine, MachineKind
from stepnc_model.entities.setup import Setup
from stepnc_model.errors import Finding, PostError, SchemaError, Severity
from stepnc_model.part21.values import Ref
from stepnc_model.post.blocks import Machine as PostMachine
from stepnc_model.post.conditions import conditions
from stepnc_model.program import Program, Workingstep
from stepnc_model.technology import programmed
from stepnc_model.tool import tool_of
from stepnc_model.toolpath.generate import require_ready, workingstep_path
from stepnc_model.toolpath.job import Stock, stock_of
from stepnc_model.toolpath.path import Feed, Move, ToolPath

USUAL_CELLS = 200_000
"""of a map: fewer than the virtual machine's, for flat cutters' sections do not come from it"""

CELLS_PER_TOOL = 16.0
"""least number of cells over the diameter of the smallest tool"""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Known:
    """A workingstep's path, and the conditions under which its file runs it."""

    path: ToolPath
    look_up: LookUp


class MeasuredCuts:
    """A source of cuts along real paths. Running state: what is left of each stock."""

    def __init__(self, program: Program, machine: Machine, kienzle: Kienzle) -> None:
        self.program = program
        self.machine = machine
        self.kienzle = kienzle
        self.control, self.limits = usual_motion(machine)
        self.left_out: dict[int, str] = {}
        """workingstep without a path by the instance number of its feature"""
        self.stocks: dict[tuple[Ref[Setup] | None, bool], MillingStock | TurningStock] = {}
        self._known: dict[int, _Known] = {}

    def cut(self, step: Workingstep) -> tuple[Cut, list[Finding]]:
        """The cut of a workingstep as programmed, and what was assumed.

        Where no path can be made, or what it meets is not known, the estimate from the feature
        takes its place, and a finding says so.

        Raises
        ------
        SchemaError
            When the workingstep lacks what a cut needs.
        """
        cut, findings = estimated_cut(self.program, step)
        try:
            known = self._path(step)
            run = run_of(known.path, known.look_up, self.machine.spindle)
        except (SchemaError, PostError) as error:
            self._without(step)
            return cut, [*findings, self._said(step, f"no tool path: {error}")]
        self._known[int(step.ref)] = known
        findings += [each for each in known.path.findings if each.severity is not Severity.NOTE]
        try:
            met = self._met(step, run)
        except SimulationError as error:
            met, why = None, str(error)
        else:
            why = "no stock is known"
        if met is None:
            findings.append(self._said(step, f"{why}: the engagement"))
        else:
            cut = self._engaged(step, cut, met)
        return self._loaded(self._timed(cut, known, run, cut.programmed), known, run, met), findings
