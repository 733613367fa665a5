"""Commands of the virtual machine: ``simulate``, ``calibrate`` and ``taptest``."""

import argparse
import re
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from service.cli.options import CONTROLS, LIMIT_EXCEEDED, OK, Commands, add_json

if TYPE_CHECKING:
    from service.simulation.run import SimulationRequest


def add_machine_commands(commands: Commands) -> None:
    """Add them to ``stepnc``."""
    _add_simulate(commands)
    _add_calibrate(commands)
    _add_tap_test(commands)


def add_what_runs(parser: argparse.ArgumentParser) -> None:
    """Machine, material, NC code, tools, stock and control."""
    add = parser.add_argument
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


def _add_calibrate(commands: Commands) -> None:
    parser = commands.add_parser(
        "calibrate",
        help="fit a machine file to measured runs of a program, or tool life to measured lives",
    )
    parser._negative_number_matcher = re.compile(r"-[.\d]")
    add = parser.add_argument
    add(
        "runs",
        type=Path,
        nargs="*",
        metavar="RUN.csv",
        help="measured runs: time_s and powers in W, named as `simulate` writes them",
    )
    add(
        "--life",
        action="append",
        default=[],
        metavar="V:T",
        help="an edge was worn after T min at V m/min, as 120:25; two or more: Taylor's law",
    )
    add(
        "--tool-life",
        type=Path,
        metavar="CSV",
        help="such pairs in a file with the columns speed_m_min and life_min",
    )
    add("--edge", default="carbide", help="of the tool lives: hss, carbide (default), ceramic")
    add("--program", type=Path, metavar="FILE", help="the STEP-NC program that was run")
    add_what_runs(parser)
    add(
        "-o",
        "--output",
        type=Path,
        metavar="TOML",
        help="write the machine as calibrated, or the [[tool_life]] table of a material",
    )
    add_json(parser)
    parser.set_defaults(run=_calibrate, refuse=parser.error)


def _add_tap_test(commands: Commands) -> None:
    parser = commands.add_parser(
        "taptest", help="modes for the stability of cuts from a measured frequency response"
    )
    add = parser.add_argument
    add(
        "response",
        type=Path,
        metavar="FRF.csv",
        help="frequency_hz and real and imaginary part: real_um_n, imag_um_n "
        "(m_n, mm_n, um_n, or m_s2_n of an accelerometer)",
    )
    add("--direction", required=True, help="of the tap: x, y, z, or xy for a round tool")
    add("--tool", default="", metavar="ID", help="tool that was tapped, as programs name it")
    add("--tool-diameter-mm", type=float, metavar="MM", help="of the tool that was tapped")
    add("--workpiece", action="store_true", help="the workpiece was tapped")
    add("--modes", type=int, metavar="N", help="how many (default: by the peaks)")
    add("--source", default="", help="who measured it, with which holder and overhang")
    add("--machine", default="", help="one of `stepnc machines`, or your own file")
    add("-o", "--output", type=Path, metavar="TOML", help="write the machine with its modes")
    add_json(parser)
    parser.set_defaults(run=_tap_test)


def _add_simulate(commands: Commands) -> None:
    parser = commands.add_parser(
        "simulate",
        help="run a program on a virtual machine: time, force, power and energy",
    )
    # Coordinates may be negative: "-3,-3,-40,153,93,2" is no option.
    parser._negative_number_matcher = re.compile(r"-[.\d]")
    add = parser.add_argument
    add("file", type=Path, nargs="?", metavar="FILE", help="a STEP-NC program (Part 21)")
    add_what_runs(parser)
    add("--rate", type=float, default=10.0, metavar="HZ", help="samples a second, 1 to 10000")
    add("--force", default="mean", help="mean of a revolution (default), or tooth by tooth")
    add("--kc-factor", type=float, default=1.0, metavar="K", help="on k_c, from calibration")
    add("--runout-um", type=float, default=0.0, metavar="UM", help="of the cutter, for teeth")
    add("--wear", action="store_true", help="tools wear while they cut (Taylor)")
    add("--lag", action="store_true", help="the main drive answers late and too far")
    add("--noise", default="none", help="of the sensors: none (default), normal or uniform")
    add("--missing", type=float, default=0.0, metavar="P", help="share of missing samples")
    add("--carbon-g-kwh", type=float, metavar="G", help="grams of CO2 for a kWh (default 480)")
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


def what_runs(options: argparse.Namespace, file: Path | None) -> "SimulationRequest":
    """The request, as far as both commands share it."""
    from service.simulation.run import SimulationRequest
    from service.simulation.setup import CodeRequest
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
    return SimulationRequest(
        file=file,
        code=code,
        machine=options.machine,
        material=options.material,
        units=options.units,
        control=options.control,
        filter_s=options.filter_s,
        deviation=options.deviation_mm,
    )


def _simulate(options: argparse.Namespace) -> int:
    """``stepnc simulate``."""
    from dataclasses import replace

    from service.simulation.carbon import WORLD, stated
    from service.simulation.run import simulate
    from service.terminal import tell

    carbon = WORLD if options.carbon_g_kwh is None else stated(options.carbon_g_kwh)
    request = replace(
        what_runs(options, options.file),
        rate=options.rate,
        zero=options.zero,
        noise=options.noise,
        missing=options.missing,
        has_lag=options.lag,
        has_wear=options.wear,
        force=options.force,
        kc_factor=options.kc_factor,
        runout_um=options.runout_um,
        seed=options.seed,
        output=options.output,
        report=options.report,
    )
    with interruptible():
        simulation = simulate(request, tell=tell)
    if options.report is not None and simulation.trace is not None:
        from service.files import write_atomically
        from service.simulation.report import simulation_page

        page = simulation_page(
            simulation, simulation.trace, material=simulation.material, carbon=carbon
        )
        write_atomically(options.report, page.encode())
        tell(f"report: {options.report}")
    if options.json:
        from service.simulation.wire import simulation_json
        from service.terminal import write_out

        write_out(simulation_json(simulation, carbon=carbon))
    else:
        from service.simulation.table import print_simulation

        print_simulation(simulation, carbon=carbon)
    return LIMIT_EXCEEDED if simulation.whole.overload_time > 0.0 else OK


def _calibrate(options: argparse.Namespace) -> int:
    """``stepnc calibrate``."""
    if options.life or options.tool_life is not None:
        return _calibrate_tool_life(options)
    if not options.runs:
        options.refuse("the following arguments are required: RUN.csv, or --life")
    from service.calibration.run import CalibrationRequest, calibrate
    from service.terminal import tell

    request = CalibrationRequest(
        runs=tuple(options.runs),
        simulation=what_runs(options, options.program),
        output=options.output,
    )
    with interruptible():
        result = calibrate(request, tell=tell)
    if options.json:
        from service.calibration.wire import calibration_json
        from service.terminal import write_out

        write_out(calibration_json(result))
    else:
        from service.calibration.table import print_calibration

        print_calibration(result)
    return OK


def _calibrate_tool_life(options: argparse.Namespace) -> int:
    """``stepnc calibrate --life``."""
    from service.calibration.tool_life import (
        ToolLifeRequest,
        calibrate_tool_life,
        tool_life_json,
        tool_life_text,
    )
    from service.terminal import tell, write_out
    from stepnc_model.errors import StepNcError

    if options.runs or options.program is not None:
        raise StepNcError("measured runs and tool lives are calibrated one at a time")
    result = calibrate_tool_life(
        ToolLifeRequest(
            pairs=tuple(options.life),
            file=options.tool_life,
            cutting_material=options.edge,
            output=options.output,
        )
    )
    if options.output is not None:
        tell(f"tool life: {options.output}")
    write_out(tool_life_json(result) if options.json else tool_life_text(result))
    return OK


def _tap_test(options: argparse.Namespace) -> int:
    """``stepnc taptest``."""
    from service.calibration.tap_table import print_tap_test, tap_test_json
    from service.calibration.tap_test import TapTestRequest, tap_test
    from service.terminal import tell, write_out

    result = tap_test(
        TapTestRequest(
            response=options.response,
            direction=options.direction,
            tool=options.tool,
            tool_diameter_mm=options.tool_diameter_mm,
            workpiece=options.workpiece,
            modes=options.modes,
            source=options.source,
            machine=options.machine,
            output=options.output,
        ),
        tell=tell,
    )
    if options.json:
        write_out(tap_test_json(result))
    else:
        print_tap_test(result)
    return OK


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
