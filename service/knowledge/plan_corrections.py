"""Corrections for a plan from the knowledge base: accepted factors on k_c, by tool."""

from collections.abc import Iterable, Iterator
from contextlib import suppress
from typing import TYPE_CHECKING

from optimiser.safety import USUAL_QUANTILE
from simulator.spec import Machine, MaterialMatch
from stepnc_model.errors import Finding, Severity, StepNcError
from stepnc_model.plurals import counted
from stepnc_model.programs.program import Program, ResolvedWorkingstep
from stepnc_model.programs.tool import tool_of

if TYPE_CHECKING:
    from service.knowledge.verbs import AcceptedFactor


def factors_for(  # noqa: PLR0913 (all that a context is made of)
    place: str,
    program: Program,
    steps: Iterable[ResolvedWorkingstep],
    *,
    machine: Machine,
    material: MaterialMatch,
    safety: float = USUAL_QUANTILE,
    is_new_allowed: bool = False,
) -> "tuple[AcceptedFactor, ...]":
    """Return the accepted factors for the tools of some workingsteps.

    Parameters
    ----------
    place : str
        File or URL; empty: from the environment, and no factors if that names none.
    safety : float
        Quantile of the factor that the plan applies, 0.5 to 0.999.
    is_new_allowed : bool
        Whether the place may be a file that does not exist yet.

    Raises
    ------
    StepNcError
        When the knowledge base cannot be read.
    """
    return factors_for_tools(
        place,
        sorted(set(_tools(program, steps))),
        machine=machine,
        material=material,
        safety=safety,
        is_new_allowed=is_new_allowed,
    )


def _tools(program: Program, steps: Iterable[ResolvedWorkingstep]) -> Iterator[str]:
    """Ids of the tools that can be read; a plan tells of the others with their workingsteps."""
    for step in steps:
        with suppress(StepNcError):
            yield tool_of(program, step.tool_ref).id


def factors_for_tools(
    place: str,
    tools: Iterable[str],
    *,
    machine: Machine,
    material: MaterialMatch,
    safety: float = USUAL_QUANTILE,
    is_new_allowed: bool = False,
) -> "tuple[AcceptedFactor, ...]":
    """Return the accepted factors for some tools by their ids, as :func:`factors_for`."""
    from service.knowledge.place import named_place  # noqa: PLC0415 (os and paths only when asked)

    found = named_place(place)
    if found is None:
        return ()
    from service.knowledge.verbs import accepted_factors  # noqa: PLC0415 (SQLAlchemy)

    return accepted_factors(
        found,
        machine=machine.name,
        material=material.material.name,
        tools=tools,
        quantile=safety,
        is_new_allowed=is_new_allowed,
    )


def finding_of(factor: "AcceptedFactor", *, safety: float) -> Finding:
    """Return a note that tells the user about an applied factor."""
    when = factor.accepted_at.date().isoformat()
    text = (
        f"tool '{factor.tool}': learned k_c × {factor.centre:.3f} from "
        f"{counted(factor.outcomes, 'outcome')}, accepted by {factor.accepted_by} on {when}; "
        f"bounds are kept at its {100.0 * safety:g} % quantile, × {factor.factor:.3f}"
    )
    return Finding(severity=Severity.NOTE, message=text)


def with_corrections(program: Program, factors: "Iterable[AcceptedFactor]") -> bytes:
    """Return the program with the corrections applied to its plan, written as entities."""
    from stepnc_model.editing.outcome_record import write_outcomes  # noqa: PLC0415 (only when learned)

    return write_outcomes(program, (), [each.correction for each in factors])
