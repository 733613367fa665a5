"""Output of feeds along the paths of NC code: text, JSON, and one self-contained page."""

from service.along_path.of_code import CodeAdvice, CodeFiles
from service.along_path.output import (
    STEP,
    along_path_record,
    print_along_path,
    profile_lines,
)
from service.files import write_atomically, write_lines
from service.reading import Tell, silent
from service.rendering.records import dump, finding_record
from service.rendering.text import RED, print_findings, print_line


def print_code_advice(code: CodeAdvice) -> None:
    """Print the faults, the comparison of both runs, what was changed, and the findings."""
    for fault in code.faults:
        print_line(str(fault), RED)
    print_line(
        f"{code.program}: control {code.control}, machine {code.machine.name} "
        f"({code.machine.title}), material {code.material.material.title}; the stock stands in "
        f"{code.frame}"
    )
    print_along_path(code.along)
    rewritten = code.rewritten
    print_line(
        f"{rewritten.changed} blocks changed, {rewritten.added} added by splitting, "
        f"{rewritten.restored} got the programmed feed back, {len(rewritten.unchanged)} not as "
        "advised"
    )
    print_findings(code.findings, told=code.faults)


def code_advice_json(code: CodeAdvice) -> str:
    """Return the feeds along the paths of NC code as JSON."""
    rewritten = code.rewritten
    return dump({
        "program": code.program,
        "control": code.control,
        "machine": code.machine.name,
        "material": code.material.material.name,
        "frame": code.frame,
        "along_path": along_path_record(code.along),
        "blocks": {
            "changed": rewritten.changed,
            "added": rewritten.added,
            "restored": rewritten.restored,
            "unchanged": [
                {"line": each.line, "reason": each.reason, "is_unsplit": each.is_unsplit}
                for each in rewritten.unchanged
            ],
        },
        "findings": [finding_record(finding) for finding in code.findings],
    })


def write_views(code: CodeAdvice, files: CodeFiles, *, tell: Tell = silent) -> None:
    """Write the report and the table of feeds, where they were asked for."""
    if files.report is not None:
        write_atomically(files.report, code_page(code).encode())
        tell(f"report: {files.report}")
    if files.feeds is not None:
        lines = write_lines(files.feeds, profile_lines(code.along))
        tell(f"feeds: {files.feeds} ({lines} lines)")


def code_page(code: CodeAdvice) -> str:
    """Return the HTML report of feeds along the paths of NC code."""
    from service.along_path.figures import along_path_figures  # noqa: PLC0415 (plotly)
    from service.rendering.pages import plot, rendered  # noqa: PLC0415 (Jinja)

    figures = enumerate(along_path_figures(code.along))
    return rendered(
        "code.html.jinja",
        code=code,
        columns=STEP,
        plots=[plot(each, f"along{row}") for row, each in figures],
    )
