"""Writing of a run's outcomes and accepted corrections into the program as entities."""

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
    """Numbers of outcomes and corrections written to a file."""

    place: Path
    run: str
    outcomes: int
    corrections: int


def write_back(
    place: str, file: Path, *, run: str = "", output: Path | None = None
) -> WrittenOutcomes:
    """Write the outcomes of a run, and the accepted corrections for its tools, to a file.

    Parameters
    ----------
    place : str
        File or URL of the knowledge base.
    file : Path
        Program that was run.
    run : str
        Id of the run; empty: the program's newest run.
    output : Path, optional
        Output file; default: ``FILE.recorded.stpnc``.

    Raises
    ------
    StepNcError
        When the run does not exist, belongs to another program, or the output is not writable.
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
    """Return the outcomes of the requested run, or of the program's newest run."""
    wanted = Selection(run=run) if run else Selection(program=program)
    newest: list[ProcessOutcome] = []
    for outcome in store.outcomes(wanted):
        if newest and outcome.run != newest[0].run:
            newest.clear()
        newest.append(outcome)
    if not newest:
        what = f"run '{run}'" if run else f"run of a program '{program}'"
        raise StepNcError(f"{store.place.shown}: no {what}; list runs with: stepnc kbe list")
    return tuple(newest)


def _in_force(
    store: Store, outcomes: tuple[ProcessOutcome, ...]
) -> tuple[LearnedCorrection, ...]:
    """Return the accepted corrections for the contexts of some outcomes."""
    contexts = dict.fromkeys(outcome.context for outcome in outcomes)
    found = (store.accepted(context) for context in contexts)
    return tuple(correction for correction in found if correction is not None)
