"""A learned factor on k_c as an outcome for the knowledge base: the door by which plans get it.

The outcome stands for all runs that the factor was learned from. `stepnc kbe add` takes its
file, `review` proposes the correction, and a person accepts it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from datetime import UTC, datetime
from math import log, sqrt
from pathlib import Path
from uuid import uuid4

from kbe.rows import OUTCOME
from service.files import write_atomically
from service.learning.force_factor import ForceFactor
from service.reading import read_program
from service.rendering.records import dump, plain
from stepnc_model.entities.milling import MillingTypeOperation
from stepnc_model.errors import StepNcError
from stepnc_model.outcome import (
    Context,
    EvaluatedQuantity,
    FeatureFacts,
    ForceRatio,
    ProcessOutcome,
)
from stepnc_model.tool import tool_of

MOST_FACTOR = 5.0
"""Factor, up or down, from which one is a mistake."""


def write_outcome(
    path: Path,
    found: ForceFactor,
    *,
    program: Path,
    names: Mapping[str, Sequence[str]],
    run: str = "",
) -> None:
    """Write the outcome of a factor as `stepnc kbe add` reads it.

    Parameters
    ----------
    path : Path
    found : ForceFactor
    program : Path
        Program of the runs, which mills with one tool.
    names : mapping
        Machines and materials of the runs, by column.
    run : str
        Id of the outcome; empty: a new one.

    Raises
    ------
    StepNcError
        When the runs are of several machines or materials, the program has several tools, or
        the factor cannot be.
    """
    one = {}
    for column in ("machine", "material"):
        values = sorted(set(names[column]))
        if len(values) != 1:
            raise StepNcError(
                f"a factor on k_c belongs to one {column}, but the runs have "
                f"{', '.join(values)}"
            )
        one[column] = values[0]
    if not 1.0 / MOST_FACTOR < found.factor < MOST_FACTOR:
        raise StepNcError(
            f"factor {found.factor:.3g} on k_c: it must be {1.0 / MOST_FACTOR:g} to "
            f"{MOST_FACTOR:g}"
        )
    outcome = _outcome(found, program, run or f"learned-{uuid4().hex[:12]}", one)
    write_atomically(path, dump([plain(OUTCOME.row(outcome))]).encode())


def _outcome(found: ForceFactor, path: Path, run: str, names: dict[str, str]) -> ProcessOutcome:
    program = read_program(path, units="iso")
    steps = [
        each
        for each in program.workingsteps
        if isinstance(each.operation, MillingTypeOperation)
    ]
    tools = {tool_of(program, each.tool_ref).id for each in steps}
    if len(tools) != 1:
        raise StepNcError(
            f"{path}: a factor on k_c belongs to one tool, but the program mills with "
            f"{', '.join(sorted(tools)) or 'none'}"
        )
    step = steps[0]
    feature = program.get(step.features[0]) if step.features else None
    nothing = EvaluatedQuantity()
    # The base of knowledge takes the readings of a ratio for correlated revolutions of one cut;
    # so the deviation of a reading is such that their mean has the error of the fit, or more.
    error = found.factor_error / found.factor
    return replace(
        EMPTY,
        context=Context(tool=tools.pop(), **names),
        program=program.name,
        workingstep=step.id,
        feature=FeatureFacts(
            id=str(getattr(feature, "its_id", "")),
            kind="" if feature is None else feature.express_name(),
        ),
        step_depth=nothing,
        force_ratio=ForceRatio(
            log_mean=log(found.factor),
            log_deviation=error * sqrt(found.runs),
            readings=found.runs,
        ),
        run=run,
        recorded_at=datetime.now(UTC),
    )


EMPTY = ProcessOutcome(
    context=Context(machine="", material="", tool=""),
    program="",
    workingstep="",
    feature=FeatureFacts(id="", kind=""),
    is_finishing=False,
    mode="TC",
    specific_force=None,
    cutting_speed=None,
    step_depth=EvaluatedQuantity(),
    feed_per_tooth=EvaluatedQuantity(),
    immersion=None,
    strategy="",
    roughness=EvaluatedQuantity(),
    time=EvaluatedQuantity(),
    force=EvaluatedQuantity(),
    feed=EvaluatedQuantity(),
    force_bound=None,
    force_ratio=None,
    trace="",
    run="",
    recorded_at=datetime.min.replace(tzinfo=UTC),
    recorded_by="stepnc learn",
)
"""Outcome in which nothing was measured."""
