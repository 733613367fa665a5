"""``stepnc record``: a machine's MTConnect data as a file."""

import argparse

from service.cli.options import OK, Commands
from service.requests.fields import output_path


def add_record_command(commands: Commands) -> None:
    """Add it to ``stepnc``."""
    parser = commands.add_parser(
        "record", help="record what the MTConnect agent of a machine tells into a file"
    )
    parser.fill = _record_options


def _record_options(parser: argparse.ArgumentParser) -> None:
    from service.requests.fields import add_options
    from service.requests.recording import RecordingRequest

    add = parser.add_argument
    add("url", metavar="URL", help="the agent, http://HOST:PORT or http://HOST:PORT/DEVICE")
    add(
        "-o",
        "--output",
        type=output_path,
        required=True,
        metavar="FILE",
        help=".parquet or .csv",
    )
    add_options(parser, RecordingRequest)
    parser.set_defaults(run=_record)


def _record(options: argparse.Namespace) -> int:
    """``stepnc record``."""
    from service.recording.run import record
    from service.rendering.text import print_line
    from service.requests.fields import from_options
    from service.requests.recording import RecordingRequest
    from service.terminal import tell

    request = from_options(RecordingRequest, options)
    found = record(options.url, options.output, request, tell=tell)
    print_line(
        f"{found.file}: {found.rows} rows, {len(found.columns)} columns, "
        f"{found.observations} observations"
    )
    if found.lost or found.restarts or found.faults:
        print_line(
            f"interrupted: {found.faults} times without connection, {found.restarts} restarts "
            f"of the agent, {found.lost} observations lost"
        )
    return OK
