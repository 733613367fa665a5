"""Functions that run the commands ``stepnc kbe …`` with their parsed options."""

import argparse
import getpass
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from service.cli.kbe_options import request_of, selection_of
from service.cli.options import OK
from service.knowledge.place import usual_place
from stepnc_model.errors import StepNcError

if TYPE_CHECKING:
    from kbe.backup import Content
    from kbe.ledger import StoredCorrection
    from service.requests.knowledge import EvaluationRequest

SUFFIXES = {
    ".csv": "csv",
    ".json": "json",
    ".html": "html",
    ".parquet": "parquet",
    ".txt": "text",
}
"""Output formats by file extension."""


def list_outcomes_command(options: argparse.Namespace) -> int:
    """Run the command ``stepnc kbe list``."""
    from service.knowledge import output
    from service.knowledge.verbs import newest
    from service.terminal import write_out

    place, selection = usual_place(options.kb), selection_of(options)
    listing = newest(place, selection, limit=options.limit)
    if not listing.total:
        _tell_why_empty(place, options)
    if options.json:
        write_out(output.listing_json(listing))
    elif listing.total:
        output.print_listing(listing)
    return OK


def show_command(options: argparse.Namespace) -> int:
    """Run the command ``stepnc kbe show``."""
    from service.knowledge import output
    from service.knowledge import verbs as knowledge
    from service.terminal import write_out

    place = usual_place(options.kb)
    outcomes = knowledge.outcomes_of_run(place, options.id)
    if outcomes:
        if options.json:
            write_out(output.run_json(outcomes))
        else:
            output.print_run(outcomes)
        return OK
    entries = [each for each in knowledge.corrections(place) if str(each.id) == options.id]
    if not entries:
        raise StepNcError(
            f"{knowledge.shown(place)}: no run or correction '{options.id}'; list them with "
            "`stepnc kbe list` or `stepnc kbe corrections`"
        )
    _show_corrections(entries, is_json=options.json)
    return OK


def table_command(options: argparse.Namespace) -> int:
    """Run the command ``stepnc kbe table``."""
    from service.knowledge.evaluation_output import put_summary, put_table

    place, form = usual_place(options.kb), _format(options)
    if options.summary:
        count = put_summary(place, selection_of(options), form=form, output=options.output)
    else:
        from service.terminal import tell

        count = put_table(place, _request(options), form=form, output=options.output, tell=tell)
    if not count:
        _tell_why_empty(place, options)
    return _written(options.output)


def _request(options: argparse.Namespace) -> "EvaluationRequest":
    from kbe.evaluation import Grouping, RowFilter, SortKey
    from service.requests.knowledge import EvaluationRequest

    return replace(
        request_of(EvaluationRequest, options),
        grouping=Grouping(options.by),
        only=RowFilter(options.only.replace("-", " ")),
        sort=SortKey(options.sort.replace("-", " ")),
    )


def _format(options: argparse.Namespace) -> str:
    """Return the format as requested, else by the file extension, else text."""
    if options.format or options.output is None:
        return options.format or "text"
    suffix = options.output.suffix.lower()
    if suffix not in SUFFIXES:
        known = ", ".join(SUFFIXES)
        raise StepNcError(f"{options.output}: end the name with {known}, or add --format")
    return SUFFIXES[suffix]


def review_command(options: argparse.Namespace) -> int:
    """Run the command ``stepnc kbe review``."""
    from kbe.acceptance import AcceptanceBounds
    from service.knowledge.review import Acceptance, review
    from service.knowledge.review_output import print_review, review_json
    from service.requests.knowledge import ReviewRequest
    from service.terminal import write_out

    place = usual_place(options.kb)
    acceptance = Acceptance(
        by=_decider(options) if options.auto_accept else "",
        bounds=AcceptanceBounds(
            least_confidence=options.least_confidence,
            fewest_outcomes=options.fewest_outcomes,
            greatest_change=options.greatest_change,
        ),
    )
    found = review(place, request_of(ReviewRequest, options), acceptance)
    if not found:
        _tell_why_empty(place, options)
    if options.json:
        write_out(review_json(found))
    elif found:
        print_review(found)
    return OK


def accept_command(options: argparse.Namespace) -> int:
    """Run the command ``stepnc kbe accept``."""
    from service.knowledge.verbs import accept

    entries = accept(usual_place(options.kb), options.ids, by=_decider(options))
    _show_corrections(entries, is_json=options.json)
    return OK


def withdraw_command(options: argparse.Namespace) -> int:
    """Run the command ``stepnc kbe withdraw``."""
    from service.knowledge.verbs import withdraw

    entries = withdraw(usual_place(options.kb), options.ids, by=_decider(options))
    _show_corrections(entries, is_json=options.json)
    return OK


def list_corrections_command(options: argparse.Namespace) -> int:
    """Run the command ``stepnc kbe corrections``."""
    from service.knowledge.verbs import corrections, shown
    from service.terminal import tell

    place = usual_place(options.kb)
    entries = corrections(place)
    if not entries:
        tell(f"{shown(place)}: no corrections yet; `stepnc kbe review` proposes them")
    if entries or options.json:
        _show_corrections(entries, is_json=options.json)
    return OK


def _show_corrections(entries: "Sequence[StoredCorrection]", *, is_json: bool) -> None:
    from service.knowledge.output import corrections_json, print_corrections
    from service.terminal import write_out

    if is_json:
        write_out(corrections_json(entries))
    else:
        print_corrections(entries)


def _decider(options: argparse.Namespace) -> str:
    """Return the name of the person who decides; the login name if none is given."""
    from service.terminal import tell

    if options.by.strip():
        return str(options.by)
    try:
        name = getpass.getuser()
    except (KeyError, OSError) as error:
        raise StepNcError(
            "no login name found; give the name of the person who decides with --by NAME"
        ) from error
    tell(f"decision recorded for login '{name}'; use --by NAME for another person")
    return name


def export_command(options: argparse.Namespace) -> int:
    """Run the command ``stepnc kbe export``."""
    from service.flat_file import Format
    from service.knowledge.export import export_corrections, export_outcomes
    from service.terminal import tell

    if options.what == "table":
        return table_command(options)
    place, name = usual_place(options.kb), _format(options)
    if name not in set(Format):
        raise StepNcError(f"outcomes and corrections cannot be written as {name}")
    form, file = Format(name), options.output
    if options.what == "outcomes":
        rows = export_outcomes(place, selection_of(options), file=file, form=form)
    else:
        rows = export_corrections(place, file=file, form=form)
    tell(f"written: {file} ({rows} {options.what})")
    return OK


def write_command(options: argparse.Namespace) -> int:
    """Run the command ``stepnc kbe write``."""
    from service.knowledge.written import write_back
    from service.terminal import tell

    place = usual_place(options.kb)
    done = write_back(place, options.file, run=options.of_run, output=options.output)
    tell(
        f"written: {done.place} (outcomes {done.outcomes}, corrections {done.corrections}, "
        f"run {done.run})"
    )
    return OK


def read_command(options: argparse.Namespace) -> int:
    """Run the command ``stepnc kbe read``."""
    from service.knowledge.recorded import print_recorded, recorded_in, recorded_json
    from service.terminal import write_out

    found = recorded_in(options.file)
    if options.json:
        write_out(recorded_json(found))
    else:
        print_recorded(found)
    return OK


def add_command(options: argparse.Namespace) -> int:
    """Run the command ``stepnc kbe add``."""
    from service.knowledge.added import add_outcomes
    from service.terminal import tell

    tell(f"added: {add_outcomes(usual_place(options.kb), options.file)}")
    return OK


def back_up_command(options: argparse.Namespace) -> int:
    """Run the command ``stepnc kbe backup``."""
    from service.knowledge.verbs import back_up

    content = back_up(usual_place(options.kb), options.file)
    _show_content(content, place=str(options.file), is_json=options.json)
    return OK


def restore_command(options: argparse.Namespace) -> int:
    """Run the command ``stepnc kbe restore``."""
    from service.knowledge.verbs import restore, shown

    place = usual_place(options.kb)
    content = restore(options.file, place)
    _show_content(content, place=shown(place), is_json=options.json)
    return OK


def check_command(options: argparse.Namespace) -> int:
    """Run the command ``stepnc kbe check``."""
    from service.knowledge.verbs import check, shown
    from service.terminal import tell

    place = usual_place(options.kb)
    content = check(place)
    _show_content(content, place=shown(place), is_json=options.json)
    tell("no damage found: every page was read")
    return OK


def _show_content(content: "Content", *, place: str, is_json: bool) -> None:
    from service.knowledge.output import content_json, print_content
    from service.terminal import write_out

    if is_json:
        write_out(content_json(content, place=place))
    else:
        print_content(content, place=place)


def _written(output: Path | None) -> int:
    from service.terminal import tell

    if output is not None:
        tell(f"written: {output}")
    return OK


def _tell_why_empty(place: str, options: argparse.Namespace) -> None:
    """Explain why no outcomes were found: none are stored, or none are selected."""
    from service.knowledge.verbs import contexts, shown
    from service.terminal import tell

    known = contexts(place)
    if not known:
        tell(f"{shown(place)}: no outcomes yet; `stepnc control FILE --kb …` records them")
        return
    names = {
        "machines": sorted({each.machine for each in known}),
        "materials": sorted({each.material for each in known}),
        "tools": sorted({each.tool for each in known}),
    }
    told = "; ".join(f"{what} {_some(them)}" for what, them in names.items())
    tell(f"{shown(place)}: no outcome matches the selection; stored are {told}")


def _some(names: Sequence[str]) -> str:
    """Return the first names of a list, and the number of others."""
    shown = ", ".join(names[:8])
    return f"{shown} and {len(names) - 8} more" if len(names) > 8 else shown
