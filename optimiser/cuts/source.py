"""Sources of cuts for the optimiser: real tool paths, or features."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Protocol

from optimiser.cuts.bare_path import is_path_only
from optimiser.cuts.cut import Cut, CutKind
from optimiser.cuts.feature_cuts import Estimates
from optimiser.cuts.two_cores import Result
from optimiser.solver.problem import Setting
from simulator.spec import Machine, MachineKind, WorkMaterial
from stepnc_model.entities.milling import MillingTypeOperation
from stepnc_model.entities.turning import TurningMachiningOperation
from stepnc_model.errors import Finding
from stepnc_model.programs.program import Program, ResolvedWorkingstep
from stepnc_model.toolpath.generate import PathOf, workingstep_path

if TYPE_CHECKING:
    from optimiser.cuts.fixtured_stock import BodyMaps


def why_elsewhere(step: ResolvedWorkingstep, machine: Machine) -> str:
    """Reason why a machine cannot run a workingstep at all; empty where it can."""
    is_lathe = machine.kind is MachineKind.LATHE
    if isinstance(step.operation, TurningMachiningOperation) and not is_lathe:
        return f"{step.operation_type} needs a lathe, and '{machine.name}' is a mill"
    if isinstance(step.operation, MillingTypeOperation) and is_lathe:
        return f"{step.operation_type} needs a mill, and '{machine.name}' is a lathe"
    return ""


class CutSource(Protocol):
    """Source of the cuts of a program's workingsteps, requested in order; may keep state."""

    def cut(self, step: ResolvedWorkingstep) -> tuple[Cut, list[Finding]]:
        """Return the cut of a workingstep as programmed, with findings on assumptions."""
        ...

    def at(self, step: ResolvedWorkingstep, cut: Cut, setting: Setting) -> Cut:
        """Return the cut with its length and time at another setting."""
        ...

    def timed(self, step: ResolvedWorkingstep, cut: Cut, setting: Setting) -> Cut:
        """Return the cut with length and time of another setting's path, not its contacts."""
        ...

    def leave_out(self, step: ResolvedWorkingstep) -> None:
        """Pass over a workingstep that is not optimised but will run."""
        ...

    def map_workingsteps(
        self, steps: Sequence[ResolvedWorkingstep], do: Callable[[ResolvedWorkingstep], Result]
    ) -> Iterator[Result]:
        """Run a function that requests cuts on each workingstep, and yield results in order."""
        ...


Source = Callable[[Program, Machine, WorkMaterial], CutSource]
"""Factory of the source of a program's cuts."""


class WiperCutSource:
    """Source of cuts that marks the turning inserts that have a wiper.

    Parameters
    ----------
    wipers : set of str
        Ids of the tools whose inserts have a wiper.
    """

    def __init__(self, cuts: CutSource, wipers: frozenset[str]) -> None:
        self.leave_out = cuts.leave_out
        self.map_workingsteps = cuts.map_workingsteps
        self._cuts = cuts
        self._wipers = wipers

    def cut(self, step: ResolvedWorkingstep) -> tuple[Cut, list[Finding]]:
        """Return the cut of a workingstep as programmed, with findings on assumptions."""
        cut, findings = self._cuts.cut(step)
        return self._with_wiper(cut), findings

    def at(self, step: ResolvedWorkingstep, cut: Cut, setting: Setting) -> Cut:
        """Return the cut with its length and time at another setting."""
        return self._with_wiper(self._cuts.at(step, cut, setting))

    def timed(self, step: ResolvedWorkingstep, cut: Cut, setting: Setting) -> Cut:
        """Return the cut with length and time of another setting's path, not its contacts."""
        return self._with_wiper(self._cuts.timed(step, cut, setting))

    def _with_wiper(self, cut: Cut) -> Cut:
        if cut.kind is not CutKind.TURNING or cut.tool.id not in self._wipers:
            return cut
        return replace(cut, tool=replace(cut.tool, has_wiper=True))


def along_paths(
    program: Program,
    machine: Machine,
    material: WorkMaterial,
    *,
    is_run: bool = False,
    body_map: "BodyMaps | None" = None,
    path_of: PathOf = workingstep_path,
) -> CutSource:
    """Source of cuts along the real tool paths in the remaining stock, timed by the machine.

    With ``is_run``, the cuts include the loads that the axes actually reach; with ``body_map``,
    raw parts that are bodies have their own shape; ``path_of`` makes the paths as programmed.
    """
    from optimiser.cuts.path_cuts import MeasuredCuts  # noqa: PLC0415 (numpy)

    return MeasuredCuts(
        program, machine, material, is_run=is_run, body_map=body_map, path_of=path_of
    )


def from_features(program: Program, machine: Machine, material: WorkMaterial) -> CutSource:
    """Source of cuts estimated from features: fast, but without the real tool path.

    Where nothing but its path tells what a workingstep cuts, all cuts are along their paths.
    """
    if any(is_path_only(program, step) for step in program.workingsteps):
        return along_paths(program, machine, material)
    return Estimates(program, machine, material)
