"""Writing of a run's outcomes and accepted corrections into the program as entities."""

from kbe.queries import Selection
from kbe.store import Store, open_store
from service.files import require_place, sibling, write_atomically
from service.knowledge.place import require_apart
from service.programs.reading import read_program
from service.progress import Tell, silent
from service.verbs.kbe.write.request import WriteFiles, WriteRequest
from service.verbs.kbe.write.result import WriteResult
from stepnc_model.editing.outcome_record import write_outcomes
from stepnc_model.errors import StepNcError
from stepnc_model.outcome import LearnedCorrection, ProcessOutcome


def run(request: WriteRequest, files: WriteFiles, *, tell: Tell = silent) -> WriteResult:
    """Write the outcomes of a run, and the accepted corrections for its tools, to a file.

    Raises
    ------
    StepNcError
        When the run does not exist, belongs to another program, or the output is not writable.
    """
    target = files.output or sibling(files.file, ".recorded.stpnc")
    require_place(target, apart_from=files.file)
    require_apart(files.place, target)
    program = read_program(files.file, units="iso")
    with open_store(files.place, is_new_allowed=False) as store:
        outcomes = _outcomes(store, program.name, request.run)
        corrections = _in_force(store, outcomes)
    write_atomically(target, write_outcomes(program, outcomes, corrections))
    return WriteResult(
        written=target,
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
