"""Commands of the virtual machine: ``simulate``."""

import argparse
from pathlib import Path

from service.cli_options import CONTROLS, OK, Commands, add_json


def add_machine_commands(commands: Commands) -> None:
    """Add them to ``stepnc``."""
    _add_simulate(commands)


def _add_simulate(commands: Commands) -> None:
    parser = commands.add_parser(
        "simulate",
        help="run a program on a virtual machine: time, force, power and energy",
    )
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
    add("--rate", type=float, default=10.0, metavar="HZ", help="samples a second, 1 to 10000")
    add("--seed", type=int, default=0, help="of noise and missing samples (default 0)")
    add("-o", "--output", type=Path, metavar="FILE", help="write the run, .parquet or .csv")
    add("--report", type=Path, metavar="HTML", help="write a self-contained page with plots")
    add_json(parser)
    parser.set_defaults(run=_simulate)


def _simulate(options: argparse.Namespace) -> int:
    """``stepnc simulate``."""
    from service.simulation import SimulationRequest, simulate
    from service.terminal import tell

    simulate(
        SimulationRequest(
            file=options.file,
            machine=options.machine,
            material=options.material,
            units=options.units,
            rate=options.rate,
            control=options.control,
            output=options.output,
        ),
        tell=tell,
    )
    return OK
