"""Job of an NC program: accepted corrections of k_c, and work-holding."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from optimiser.along_path.tool_bounds import KnownOfJob
from optimiser.cuts.conditions import grip_of_bar
from service.knowledge.plan_corrections import factors_for_tools, finding_of
from service.programs.raw_stock import raw_stock_of
from service.requests.advice import AdviceRequest
from service.simulation.code_paths import CodePaths
from simulator.physics.holding import LEAST_LEFT, usable_speed
from simulator.spec import Machine
from simulator.work_holding import Chuck, Holding
from stepnc_model.errors import Finding, Severity, StepNcError
from stepnc_model.units import rpm_from_rev_s

if TYPE_CHECKING:
    from service.knowledge.verbs import AcceptedFactor


@dataclass(frozen=True, slots=True, kw_only=True)
class CodeJob:
    """Data of a job, by tool id."""

    corrections: Mapping[str, KnownOfJob] = field(default_factory=dict)
    others: KnownOfJob = field(default_factory=KnownOfJob)
    """What is known for tools without a correction."""
    findings: tuple[Finding, ...] = ()
    """Corrections that are applied, and what of the work-holding is not looked at."""
    faults: tuple[Finding, ...] = ()

    def of_tool(self, id: str) -> KnownOfJob:
        """Facts that hold for a tool."""
        return self.corrections.get(id, self.others)


def job_of(code: CodePaths, request: AdviceRequest, *, knowledge: str) -> CodeJob:
    """Read what is known of the job of an NC program.

    Parameters
    ----------
    knowledge : str
        Knowledge base; empty: the one that the environment names.

    Raises
    ------
    StepNcError
        When the knowledge base cannot be read, or the work-holding does not suit the program.
    """
    holding = _holding(code.machine)
    grip = None
    if isinstance(holding, Chuck):
        grip = grip_of_bar(holding, raw_stock_of(request.stock).bounds)
    others = KnownOfJob(
        holding=holding, grip=grip, roughness_quantile=request.roughness_quantile
    )
    factors = _factors(code, request, knowledge)
    return CodeJob(
        corrections={
            each.tool: replace(
                others, force_factor=each.centre, safety_factor=each.factor / each.centre
            )
            for each in factors
        },
        others=others,
        findings=(
            *(finding_of(each, safety=request.safety) for each in factors),
            *_notes(holding),
        ),
        faults=_too_fast(code, holding),
    )


def _factors(
    code: CodePaths, request: AdviceRequest, knowledge: str
) -> "tuple[AcceptedFactor, ...]":
    """Accepted corrections of k_c for the tools of the program."""
    if not request.has_corrections or code.material is None:
        return ()
    used = {part.tool for part in code.parts}
    return factors_for_tools(
        knowledge,
        sorted({tool.id for number, tool in code.tools.items() if number in used}),
        machine=code.machine,
        material=code.material,
        safety=request.safety,
    )


def _holding(machine: Machine) -> Holding | None:
    """Work-holding of the one setup of NC code.

    Raises
    ------
    StepNcError
        When several tables could be meant.
    """
    found = {each.setup: each for each in machine.holdings}
    if "" in found or len(found) <= 1:
        return found.get("") or next(iter(found.values()), None)
    names = ", ".join(f"'{name}'" for name in found)
    raise StepNcError(
        f"NC code has one setup, and the [[holding]] tables name {names}: give one of them"
    )


def _notes(holding: Holding | None) -> Iterator[Finding]:
    """Notes on the work-holding that is taken, and on what of it is not looked at."""
    if holding is not None and holding.setup:
        text = f"the work-holding of setup '{holding.setup}' is taken for this code"
        yield Finding(severity=Severity.NOTE, message=text)
    if isinstance(holding, Chuck):
        text = (
            "how far a slender bar bends is not bounded: NC code states no tolerance of its "
            "diameters"
        )
        yield Finding(severity=Severity.NOTE, message=text)


def _too_fast(code: CodePaths, holding: Holding | None) -> tuple[Finding, ...]:
    """Fault of spindle speeds at which a chuck holds hardly any more."""
    if not isinstance(holding, Chuck):
        return ()
    speeds = np.nan_to_num(np.abs(code.program.moves.spindle))
    fastest, usable = float(speeds.max(initial=0.0)), usable_speed(holding)
    if fastest <= usable:
        return ()
    text = (
        f"the spindle turns at up to {rpm_from_rev_s(fastest):.0f} rpm; the chuck holds less "
        f"than {LEAST_LEFT:.0%} of its force above {rpm_from_rev_s(usable):.0f} rpm"
    )
    return (Finding(severity=Severity.ERROR, message=text),)
