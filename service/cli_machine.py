"""Commands of the virtual machine: ``simulate``."""

import argparse
import re
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from service.cli_options import CONTROLS, LIMIT_EXCEEDED, OK, Commands, add_json


def add_machine_commands(commands: Commands) -> None:
    """Add them to ``stepnc``."""
    _add_simulate(commands)


def _add_simulate(commands: Commands) -> None:
    parser = commands.add_parser(
        "simulate",
        help="run a program on a virtual machine: time, force, power and energy",
    )
    # Coordinates may be negative: "-3,-3,-40,153,93,2" is no option.
    parser._negative_number_matcher = re.compile(r"-[.\d]")
    add = parser.add_argument
    add("file", type=Path, nargs="?", metavar="FILE", help="a STEP-NC program (Part 21)")
    add("--units", default="iso", help="units of feeds and speeds in the file (default: iso)")
    add("--machine", default="", help="one of `stepnc machines`, or your own TOML or XML file")
    add("--material", default="", help="one of `stepnc materials`, or your own TOML file")
    add("--nc", type=Path, metavar="CODE", help="run this NC code instead of the program's own")
    add("--dialect", default="", metavar="NAME", help=f"of the NC code: {CONTROLS}")
    add("--tools", type=Path, metavar="TOML", help="tool table, for NC code without a program")
    add(
        "--stock",
        default="",
        metavar="NUMBERS",
        help="stock for NC code without a program: x0,y0,z0,x1,y1,z1 or diameter,z0,z1 in mm",
    )
    add(
        "--control",
        default="fir",
        help="how the control runs the path: exact-stop, junction or fir (default)",
    )
    add(
        "--filter-s",
        default="",
        metavar="T1,T2",
        help="times of the fir control in s (default: by the axes' acceleration and jerk)",
    )
    add(
        "--deviation-mm",
        type=float,
        default=0.01,
        metavar="MM",
        help="of the junction control (default 0.01)",
    )
    add("--rate", type=float, default=10.0, metavar="HZ", help="samples a second, 1 to 10000")
    add("--force", default="mean", help="mean of a revolution (default), or tooth by tooth")
    add("--runout-um", type=float, default=0.0, metavar="UM", help="of the cutter, for teeth")
    add("--wear", action="store_true", help="tools wear while they cut (Taylor)")
    add("--lag", action="store_true", help="the main drive answers late and too far")
    add("--noise", default="none", help="of the sensors: none (default), normal or uniform")
    add("--missing", type=float, default=0.0, metavar="P", help="share of missing samples")
    add("--seed", type=int, default=0, help="of noise and missing samples (default 0)")
    add(
        "--zero",
        default="",
        metavar="X,Y,Z",
        help="place of the program's zero on the axes in mm (default: by the stock)",
    )
    add("-o", "--output", type=Path, metavar="FILE", help="write the run, .parquet or .csv")
    add("--report", type=Path, metavar="HTML", help="write a self-contained page with plots")
    add_json(parser)
    parser.set_defaults(run=_simulate)


def _simulate(options: argparse.Namespace) -> int:
    """``stepnc simulate``."""
    from service.simulation import SimulationRequest, simulate
    from service.simulation_setup import CodeRequest
    from service.terminal import tell
    from stepnc_model.errors import StepNcError

    code = None
    if options.nc is None and (options.dialect or options.tools or options.stock):
        raise StepNcError("--dialect, --tools and --stock are for NC code: name it with --nc")
    if options.nc is not None:
        code = CodeRequest(
            code=options.nc,
            dialect=options.dialect,
            tools=options.tools,
            stock=options.stock,
        )
    request = SimulationRequest(
        file=options.file,
        code=code,
        machine=options.machine,
        material=options.material,
        units=options.units,
        rate=options.rate,
        control=options.control,
        filter_s=options.filter_s,
        deviation=options.deviation_mm,
        zero=options.zero,
        noise=options.noise,
        missing=options.missing,
        has_lag=options.lag,
        has_wear=options.wear,
        force=options.force,
        runout_um=options.runout_um,
        seed=options.seed,
        output=options.output,
        report=options.report,
    )
    with interruptible():
        simulation = simulate(request, tell=tell)
    if options.report is not None and simulation.trace is not None:
        from service.files import write_atomically
        from service.simulation_report import simulation_page

        page = simulation_page(simulation, simulation.trace, material=simulation.material)
        write_atomically(options.report, page.encode())
        tell(f"report: {options.report}")
    if options.json:
        from service.simulation_wire import simulation_json
        from service.terminal import write_out

        write_out(simulation_json(simulation))
    else:
        from service.simulation_table import print_simulation

        print_simulation(simulation)
    return LIMIT_EXCEEDED if simulation.whole.overload_time > 0.0 else OK


@contextmanager
def interruptible() -> Iterator[None]:
    """A long run ends at SIGINT and SIGTERM alike as one that was interrupted.

    The compiler of the kernels may lose the exception and fail with one of its own.
    """
    asked: list[int] = []

    def ask(number: int, _frame: object) -> None:
        asked.append(number)
        raise KeyboardInterrupt

    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        for number, handler in before.items():
            if handler is not signal.SIG_IGN:
                signal.signal(number, ask)
        yield
    except RuntimeError as error:
        if asked:
            raise KeyboardInterrupt from error
        raise
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
