"""``stepnc factory``: run a shop of machines, buffers and crews."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from service.cli.options import OK, Commands, add_cluster, add_json

if TYPE_CHECKING:
    from service.requests.factory import FactoryRequest

REPORT = "factory.html"


def add_factory_command(commands: Commands) -> None:
    """Add it to ``stepnc``."""
    parser = commands.add_parser(
        "factory", help="run a shop: batches through machines, with times, states and energy"
    )
    parser.fill = _factory_options


def _factory_options(parser: argparse.ArgumentParser) -> None:
    from service.requests.factory import FactoryRequest, LiveFactoryRequest
    from service.requests.fields import add_options

    add = parser.add_argument
    add("shop", type=Path, metavar="SHOP", help="shop file, .toml or .json")
    add_options(parser, FactoryRequest)
    add(
        "-o",
        "--output",
        type=Path,
        metavar="FOLDER",
        help="write tables of parts, states and documents of the first replication",
    )
    add(
        "--report",
        action="store_true",
        help="write a self-contained page with pictures into the folder",
    )
    add(
        "--live",
        dest="is_live",
        action="store_true",
        help="run the shop at a pace, each machine as a device of one MTConnect agent",
    )
    add_options(parser, LiveFactoryRequest)
    add_cluster(parser)
    add_json(parser)
    parser.set_defaults(run=_factory)


def _factory(options: argparse.Namespace) -> int:
    """Run the command ``stepnc factory``."""
    from service.execution.pools import pools_of
    from service.factory.output import factory_json, factory_page, print_factory
    from service.factory.run import run_factory
    from service.files import write_atomically
    from service.requests.factory import FactoryRequest
    from service.requests.fields import from_options
    from service.terminal import tell, write_out
    from stepnc_model.errors import StepNcError

    request = from_options(FactoryRequest, options)
    if options.is_live:
        return _live(options, request)
    if options.output is None and (options.report or request.documents or request.has_energy):
        raise StepNcError("--report, --documents and --energy write files: name a folder, -o")
    pools = pools_of(options.cluster)
    result = run_factory(options.shop, request, folder=options.output, pools=pools, tell=tell)
    if options.output is not None:
        tell(f"written: {options.output} ({result.parts_written} parts)")
    if request.documents:
        tell(f"MTConnect documents: {result.documents_written}")
    if options.report:
        report = options.output / REPORT
        write_atomically(report, factory_page(result).encode())
        tell(f"report: {report}")
    if options.json:
        write_out(factory_json(result))
    else:
        print_factory(result)
    return OK


def _live(options: argparse.Namespace, request: "FactoryRequest") -> int:
    """Run a shop for clients until interrupted."""
    from service.factory.serve import serve_shop
    from service.requests.factory import LiveFactoryRequest
    from service.requests.fields import from_options
    from service.terminal import tell
    from stepnc_model.errors import StepNcError

    if options.output is not None or options.report or options.json:
        raise StepNcError(
            "--live serves clients and writes nothing: leave out -o, --report, --json"
        )
    live = from_options(LiveFactoryRequest, options)
    serve_shop(options.shop, request, live, tell=tell)
    return OK
