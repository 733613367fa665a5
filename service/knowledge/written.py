"""Outcomes of a run and accepted corrections, written into the program as entities."""

from dataclasses import dataclass
from pathlib import Path

from kbe.selection import Selection
from kbe.store import Store, open_store
from service.files import beside, require_place, write_atomically
from service.knowledge.place import require_apart
from service.reading import read_program
from stepnc_model.errors import StepNcError
from stepnc_model.outcome import LearnedCorrection, ProcessOutcome
from stepnc_model.outcome_record import write_outcomes


@dataclass(frozen=True, slots=True, kw_only=True)
class WrittenOutcomes:
    """Content that was written to the file."""

    place: Path
    run: str
    outcomes: int
    corrections: int


def write_back(
    place: str, file: Path, *, run: str = "", output: Path | None = None
) -> WrittenOutcomes:
    """Write the outcomes of one run, and the corrections in force for its tools.

    Parameters
    ----------
    place : str
        File or URL of the knowledge base.
    file : Path
        The program that was run.
    run : str
        Its id; the program's newest run when empty.
    output : Path, optional
        Default: ``FILE.recorded.stpnc``.

    Raises
    ------
    StepNcError
        When there is no such run, the program is another, or the output cannot be written.
    """
    target = output or beside(file, ".recorded.stpnc")
    require_place(target, apart_from=file)
    require_apart(place, target)
    program = read_program(file, units="iso")
    with open_store(place, is_new_allowed=False) as store:
        outcomes = _outcomes(store, program.name, run)
        corrections = _in_force(store, outcomes)
    write_atomically(target, write_outcomes(program, outcomes, corrections))
    return WrittenOutcomes(
        place=target,
        run=outcomes[0].run,
        outcomes=len(outcomes),
        corrections=len(corrections),
    )


def _outcomes(store: Store, program: str, run: str) -> tuple[ProcessOutcome, ...]:
    """Those of the run that is meant."""
    wanted = Selection(run=run) if run else Selection(program=program)
    newest: list[ProcessOutcome] = []
    for outcome in store.outcomes(wanted):
        if newest and outcome.run != newest[0].run:
            newest.clear()
        newest.append(outcome)
    if not newest:
        what = f"run '{run}'" if run else f"run of a program '{program}'"
        raise StepNcError(f"{store.place.shown}: no {what}; list them: stepnc kbe list")
    return tuple(newest)


def _in_force(
    store: Store, outcomes: tuple[ProcessOutcome, ...]
) -> tuple[LearnedCorrection, ...]:
    """Accepted corrections of the contexts of some outcomes."""
    contexts = dict.fromkeys(outcome.context for outcome in outcomes)
    found = (store.accepted(context) for context in contexts)
    return tuple(correction for correction in found if correction is not None)
