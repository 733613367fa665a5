"""Command ``stepnc control``: run a program under force control on the virtual machine."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from service.cli.machine import add_code, run_files, run_request
from service.cli.options import (
    BAD_INPUT,
    LIMIT_EXCEEDED,
    OK,
    Commands,
    add_json,
    add_knowledge,
    text,
)
from service.requests.fields import output_path

if TYPE_CHECKING:
    from service.requests.runs import ControlRequest

EXAMPLES = """examples:
  stepnc control part.stpnc --machine vmc15 --material c45 --preview
  stepnc control part.stpnc --machine vmc15 --disturb depth:+50%@12s --disturb kc:1.2
  stepnc control part.stpnc --machine vmc15 --law mpc --sensor power -o run.parquet \\
      --report run.html

Run a program on the virtual machine while a control loop measures the cutting force and sets
the feed override: TC as fast as force and chip load allow, QC at the programmed feed or slower
if the force requires it.

disturbances, unknown to the loop:
  from a time on        depth:+50%@12s hardness:+30%@12s material:NAME@12s tooth:1@12s
                        silence:2s@12s line:off@12s override:80%@12s
  from the start        kc:1.3 wear:0.05mm/min runout:20um lag:60ms noise:3% drift:1N/s
                        missing:5% readings:20ms jitter:10%
  orders of an operator power:-50%@12s mode:QC@12s control:off@12s

--law none only monitors: the feed stays as programmed, and load, wear and events are told.

Exit code 5: the loop stopped the program (a broken tooth, a worn tool, too many feed holds),
the machine no longer answered or did not follow the override, the force stayed above its set
point, or the loop asks for a tool change."""


def add_control_command(commands: Commands) -> None:
    """Add the command ``control`` to ``stepnc``."""
    parser = commands.add_parser(
        "control",
        help="run a program under closed-loop control of the cutting force",
        description=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.fill = _options


def _options(parser: argparse.ArgumentParser) -> None:
    from service.requests.fields import add_options
    from service.requests.runs import ControlRequest

    add = parser.add_argument
    add("file", type=Path, nargs="?", metavar="FILE", help="a STEP-NC program (Part 21)")
    add_options(parser, ControlRequest)
    add_code(parser)
    add(
        "--band",
        default="20,120",
        metavar="LOW,HIGH",
        help="override band, %% (default 20,120); the guard may go lower to protect the tool",
    )
    add(
        "-o",
        "--output",
        type=output_path,
        metavar="FILE",
        help="write the run, .parquet or .csv",
    )
    add(
        "--report",
        type=output_path,
        metavar="HTML",
        help="write a self-contained page with plots",
    )
    add(
        "--recorded",
        metavar="FILE|URL",
        help="evaluate a recorded run of the program instead: a .parquet or .csv file of "
        "`record`, or the next run that an MTConnect agent publishes",
    )
    add(
        "--loads",
        type=output_path,
        metavar="FILE",
        help="reference loads by tool and cut (JSON): a cut that has none teaches its own, "
        "later runs are compared with it",
    )
    add("--teach", action="store_true", help="teach the loads of all cuts anew")
    add(
        "--cut-log",
        type=output_path,
        metavar="CSV",
        help="write a row for each cut: times, powers, reference load, least feed, wear, and "
        "what was done",
    )
    add_knowledge(parser, "records the outcomes and supplies accepted corrections")
    add(
        "--by",
        type=text,
        default="",
        metavar="NAME",
        help="author of the outcomes (default: login)",
    )
    add_json(parser)
    parser.set_defaults(run=_control)


def _control(options: argparse.Namespace) -> int:
    """Run the command ``stepnc control``."""
    from dataclasses import replace

    from service.control.facts import exceeded, rows
    from service.control.record import control_recorded
    from service.terminal import tell

    run = control_recorded(
        _request(options),
        replace(
            run_files(options, options.file),
            recorded=_recorded(options),
            loads=options.loads,
            is_teaching=options.teach,
            cut_log=options.cut_log,
        ),
        knowledge=options.kb,
        by=options.by,
        tell=tell,
    )
    if options.report is not None and run.trace is not None:
        from service.control.output import control_page
        from service.files import write_atomically

        page = control_page(run, run.trace).encode(errors="replace")
        write_atomically(options.report, page)
        tell(f"report: {options.report}")
    if options.json:
        from service.control.output import control_json
        from service.terminal import write_out

        write_out(control_json(run))
    else:
        from service.control.output import print_control

        print_control(run)
    if run.faults:
        return BAD_INPUT
    return LIMIT_EXCEEDED if exceeded(run, rows(run)) else OK


def _recorded(options: argparse.Namespace) -> Path | None:
    """Return the file of the recorded run; the next run of an agent is recorded first."""
    if options.recorded is None:
        return None
    if "://" not in options.recorded:
        return Path(options.recorded)
    from service.recording.run import record
    from service.requests.recording import RecordingRequest
    from service.terminal import tell
    from stepnc_model.errors import StepNcError

    if options.file is None:
        raise StepNcError("--recorded needs a STEP-NC program: it is compared with its plan")
    file = Path(f"{options.file.stem}.recorded.parquet")
    tell(f"{options.recorded}: waiting for the next run of the program")
    record(options.recorded, file, RecordingRequest(is_next_run=True), tell=tell)
    tell(f"recorded: {file}")
    return file


def _request(options: argparse.Namespace) -> "ControlRequest":
    from service.numbers import numbers_in
    from service.requests.runs import ControlRequest

    low, high = numbers_in(options.band, "override band", counts=(2,))
    return run_request(
        ControlRequest, options, override_low_percent=low, override_high_percent=high
    )
