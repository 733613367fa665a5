"""The command ``stepnc control``: a program under the closed loop, on the virtual machine."""

import argparse
import re
from pathlib import Path
from typing import TYPE_CHECKING

from service.cli.machine import add_what_runs, interruptible, what_runs
from service.cli.options import (
    LIMIT_EXCEEDED,
    OK,
    Commands,
    add_json,
    add_knowledge,
    text,
)

if TYPE_CHECKING:
    from service.control.run import ControlRequest

EXAMPLES = """examples:
  stepnc control part.stpnc --machine vmc15 --material c45 --preview
  stepnc control part.stpnc --machine vmc15 --disturb depth:+50%@12s --disturb kc:1.2
  stepnc control part.stpnc --machine vmc15 --law mpc --sensor power -o run.parquet \\
      --report run.html

Run a program on the virtual machine while a control loop reads the cutting force and sets the
feed override: TC as fast as force and chip load allow, QC at the programmed feed and slower
where the force demands it.

disturbances, which the loop is not told of:
  from a time on        depth:+50%@12s hardness:+30%@12s material:NAME@12s tooth:1@12s
                        silence:2s@12s line:off@12s
  from the start        kc:1.3 wear:0.05mm/min runout:20um lag:60ms noise:3% drift:1N/s
                        missing:5%
  what an operator does power:-50%@12s mode:QC@12s control:off@12s

Exit code 5: the loop stopped the program (a broken tooth, too many holds of the feed), the
machine did not answer any more, or the force stayed above its set point."""


def add_control_command(commands: Commands) -> None:
    """Add it to ``stepnc``."""
    parser = commands.add_parser(
        "control",
        help="run a program under closed-loop control of the cutting force",
        description=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser._negative_number_matcher = re.compile(r"-[.\d]")
    add = parser.add_argument
    add("file", type=Path, nargs="?", metavar="FILE", help="a STEP-NC program (Part 21)")
    add_what_runs(parser)
    add("--mode", default="TC", help="TC (default) or QC")
    add(
        "--law",
        default="log-pi",
        help="log-pi (default), pi, fuzzy, self-tuning, mrac, mpc or none: the program's feed",
    )
    add("--preview", action="store_true", help="tell the law what the program knows ahead")
    add(
        "--look-ahead",
        type=int,
        default=8,
        metavar="N",
        help="revolutions that the preview reaches, 1 to 50 (default 8)",
    )
    add(
        "--disturb",
        action="append",
        default=[],
        metavar="WHAT:VALUE[@TIME]",
        help="see above; repeatable",
    )
    add("--seed", type=int, default=0, help="of the instruments' noise (default 0)")
    add(
        "--force",
        type=float,
        metavar="N",
        help="set point of the cutting force (default: what the plan's limits allow)",
    )
    add(
        "--band",
        default="20,120",
        metavar="LOW,HIGH",
        help="of the override, %% (20,120); the guard goes below where the tool is in danger",
    )
    add("--sensor", default="dynamometer", help="dynamometer (default), or power of the drive")
    add("-o", "--output", type=Path, metavar="FILE", help="write the run, .parquet or .csv")
    add("--report", type=Path, metavar="HTML", help="write a self-contained page with plots")
    add_knowledge(parser, "keep the outcomes there, take accepted corrections from it")
    add("--by", type=text, default="", metavar="NAME", help="who records (the login name)")
    add_json(parser)
    parser.set_defaults(run=_control)


def _control(options: argparse.Namespace) -> int:
    """``stepnc control``."""
    from service.control.facts import exceeded, rows
    from service.control.record import control_recorded
    from service.terminal import tell

    with interruptible():
        run = control_recorded(_request(options), tell=tell)
        if options.report is not None and run.trace is not None:
            from service.control.report import control_page
            from service.files import write_atomically

            page = control_page(run, run.trace).encode(errors="replace")
            write_atomically(options.report, page)
            tell(f"report: {options.report}")
    if options.json:
        from service.control.wire import control_json
        from service.terminal import write_out

        write_out(control_json(run))
    else:
        from service.control.table import print_control

        print_control(run)
    return LIMIT_EXCEEDED if exceeded(run, rows(run)) else OK


def _request(options: argparse.Namespace) -> "ControlRequest":
    from service.control.run import ControlRequest
    from service.numbers import numbers_in

    low, high = numbers_in(options.band, "override band", counts=(2,))
    return ControlRequest(
        simulation=what_runs(options, options.file),
        mode=options.mode,
        law=options.law,
        has_preview=options.preview,
        look_ahead=options.look_ahead,
        disturbances=tuple(options.disturb),
        seed=options.seed,
        set_point=options.force,
        band=(low, high),
        sensor=options.sensor,
        output=options.output,
        report=options.report,
        knowledge=options.kb,
        recorded_by=options.by,
    )
