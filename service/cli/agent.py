"""``stepnc agent``: a program on the virtual machine as an MTConnect agent."""

import argparse
from pathlib import Path

from service.cli.machine import (
    USUAL_RATE,
    add_code,
    run_files,
    run_request,
)
from service.cli.options import OK, Commands


def add_agent_command(commands: Commands) -> None:
    """Add it to ``stepnc``."""
    parser = commands.add_parser(
        "agent", help="publish a run on a virtual machine as an MTConnect agent"
    )
    parser.fill = _agent_options


def _agent_options(parser: argparse.ArgumentParser) -> None:
    from service.requests.agent import AgentRequest
    from service.requests.fields import add_options

    add = parser.add_argument
    add("file", type=Path, nargs="?", metavar="FILE",
        help="a STEP-NC program or a recorded run (.parquet, .csv, .xml, .shdr, .log)",
    )  # fmt: skip
    add("--device", type=Path, metavar="XML",
        help="device model of the adapters or the recorded run",
    )  # fmt: skip
    add("--schema-files", type=Path, metavar="FOLDER",
        help="a folder of schemas (*.xsd) to serve at /schemas")  # fmt: skip
    add("--runs", type=Path, metavar="FOLDER",
        help="keep each run in this folder, and serve them at /runs")  # fmt: skip
    add_options(parser, AgentRequest, usual={"rate_hz": USUAL_RATE})
    add_code(parser)
    parser.set_defaults(run=_agent, output=None)


def _agent(options: argparse.Namespace) -> int:
    """``stepnc agent``."""
    from service.agent.run import AgentFiles, serve_agent
    from service.requests.agent import AgentRequest
    from service.terminal import tell

    request = run_request(AgentRequest, options, rate_hz=USUAL_RATE)
    files = AgentFiles(
        run=run_files(options, options.file),
        device=options.device,
        schemas=options.schema_files,
        runs=options.runs,
    )
    serve_agent(request, files, tell=tell)
    return OK
