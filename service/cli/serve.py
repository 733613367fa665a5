"""Commands ``stepnc serve`` and ``stepnc keys``: the service and its API keys."""

import argparse
import os
from pathlib import Path
from typing import TYPE_CHECKING

from service.cli.options import OK, Commands, text

if TYPE_CHECKING:
    from service.storage.folder import DataFolder

VARIABLE = "STEPNC_DATA"
"""Environment variable that names the data folder."""

DATABASE_VARIABLE = "STEPNC_DATABASE"
"""Environment variable that names the database; not shown to other users, unlike arguments."""

USUAL_RATE = 50.0
"""Default rate limit for clients on other computers, in requests per second."""

LEVELS = ("debug", "info", "warning", "error")
ROLES = ("viewer", "planner", "operator")

SERVE = """examples:
  stepnc serve
  stepnc serve --data /srv/stepnc --workers 2
  stepnc serve --agent vmc15=http://192.168.0.7:5000/vmc15
  stepnc serve --database postgresql://stepnc@db.shop/stepnc --files /mnt/stepnc
  stepnc serve --host 0.0.0.0 --name planner.shop --tls-cert shop.crt --tls-key shop.key

Serve the REST API and the dashboard. API keys are required unless the service listens on this
computer's loopback address only: see `stepnc keys create`."""


def add_service_commands(commands: Commands) -> None:
    """Add the commands ``serve`` and ``keys`` to ``stepnc``."""
    parser = commands.add_parser(
        "serve",
        help="serve advised feeds over REST, and the dashboard",
        description=SERVE,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add = parser.add_argument
    add("--host", default="127.0.0.1", help="address to listen on (default: 127.0.0.1)")
    add("--port", type=int, default=8000, help="port to listen on (default: 8000)")
    _add_data(parser)
    add(
        "--kb",
        type=text,
        default="",
        metavar="PLACE",
        help="knowledge base, a file or postgresql://… (default: $STEPNC_KB, else --database, "
        "else in --data)",
    )
    add("--workers", type=int, default=1, metavar="N", help="web processes (default: 1)")
    add("--jobs", type=int, default=1, metavar="N", help="jobs that run at once (default: 1)")
    add(
        "--job-memory",
        type=int,
        default=8,
        metavar="GB",
        help="address space of a job, of which libraries reserve 1 to 2 GB (default: 8)",
    )
    add(
        "--name",
        action="append",
        default=[],
        metavar="HOST",
        help="a host name by which clients reach this computer, beside its addresses; "
        "repeatable",
    )
    add(
        "--agent",
        action="append",
        default=[],
        metavar="NAME=URL",
        help="monitor the MTConnect agent of a machine of the library or shop; repeatable",
    )
    add("--keys", action="store_true", help="require API keys on loopback too")
    add("--tls-cert", type=Path, metavar="FILE", help="TLS certificate: serve https")
    add("--tls-key", type=Path, metavar="FILE", help="private key of the certificate")
    add(
        "--upload-mb",
        type=int,
        default=32,
        metavar="MB",
        help="largest program that may be uploaded, unpacked (default: 32)",
    )
    add(
        "--rate",
        type=float,
        metavar="R",
        help="requests per second and client (default: 50, no limit on loopback)",
    )
    add("--log-level", choices=LEVELS, default="info", help="level of the JSON log on stderr")
    parser.set_defaults(run=_serve)
    _add_keys(commands)


def _add_keys(commands: Commands) -> None:
    parser = commands.add_parser("keys", help="API keys of the service: create, list, revoke")
    verbs = parser.add_subparsers(dest="verb", metavar="VERB", required=True)
    create = verbs.add_parser("create", help="create a key; it is shown only once")
    create.add_argument("--for", dest="who", type=text, required=True, metavar="NAME")
    create.add_argument(
        "--role",
        action="append",
        choices=ROLES,
        default=[],
        help="viewer reads, planner plans, operator runs; repeatable (default: viewer)",
    )
    listing = verbs.add_parser("list", help="list the keys, without their secrets")
    revoke = verbs.add_parser("revoke", help="revoke a key")
    revoke.add_argument("id", help="id of the key, as listed")
    for verb, run in ((create, _create), (listing, _list), (revoke, _revoke)):
        _add_data(verb)
        verb.set_defaults(run=run)


def _add_data(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--data",
        type=Path,
        default=None,
        metavar="DIR",
        help="data folder (default: $STEPNC_DATA, else ~/.local/share/stepnc/service)",
    )
    parser.add_argument(
        "--database",
        type=text,
        default="",
        metavar="URL",
        help="postgresql://USER@HOST/DATABASE that several hosts share "
        "(default: $STEPNC_DATABASE, else a file in --data)",
    )
    parser.add_argument(
        "--files",
        type=text,
        default="",
        metavar="PLACE",
        help="folder of programs and results, or s3://… or another URL of fsspec, shared by "
        "the hosts of one --database (default: --data)",
    )


def _serve(options: argparse.Namespace) -> int:
    from service.known_hosts import LOOPBACK
    from service.monitor.source import sources_of
    from service.process_limits import GIB
    from service.rest.serve import ServerOptions, serve
    from service.rest.settings import MIB, Settings

    _require(options)
    is_loopback = options.host in LOOPBACK
    rate = options.rate if options.rate is not None else (0.0 if is_loopback else USUAL_RATE)
    settings = Settings(
        data=str(_data(options)),
        knowledge=options.kb,
        database=_database(options),
        files=options.files,
        host=options.host,
        port=options.port,
        names=tuple(options.name),
        agents=sources_of(options.agent),
        needs_keys=options.keys or not is_loopback,
        upload_bytes=options.upload_mb * MIB,
        rate=rate,
        level=options.log_level,
    )
    serve(
        ServerOptions(
            settings=settings,
            workers=options.workers,
            jobs=options.jobs,
            job_memory=options.job_memory * GIB,
            certificate=options.tls_cert,
            key=options.tls_key,
        )
    )
    return OK


def _require(options: argparse.Namespace) -> None:
    """Refuse option values that are out of range."""
    from stepnc_model.errors import StepNcError

    for name, value, low, high in (
        ("port", options.port, 0, 65_535),
        ("workers", options.workers, 1, 64),
        ("jobs", options.jobs, 1, 64),
        ("job-memory", options.job_memory, 2, 4096),
        ("upload-mb", options.upload_mb, 1, 1024),
        ("rate", 0.0 if options.rate is None else options.rate, 0.0, 1e6),
    ):
        if not low <= value <= high:
            raise StepNcError(f"--{name} {value:g}: it must be {low:g} to {high:g}")
    if (options.tls_cert is None) != (options.tls_key is None):
        raise StepNcError("--tls-cert and --tls-key must be given together")


def _data(options: argparse.Namespace) -> Path:
    """Return the data folder: as named, from the environment, or the default one."""
    from service.knowledge.place import usual_file

    named = options.data or os.environ.get(VARIABLE)
    return Path(named) if named else usual_file().with_name("service")


def _database(options: argparse.Namespace) -> str:
    """Return the address of the database; empty: a file in the data folder."""
    return str(options.database or os.environ.get(DATABASE_VARIABLE, ""))


def _data_folder(options: argparse.Namespace, *, is_made: bool = False) -> "DataFolder":
    """Open the data folder, which must exist unless the first key is created."""
    from service.storage.folder import DATABASE, open_data_folder
    from stepnc_model.errors import StepNcError

    folder, database = _data(options), _database(options)
    if not (is_made or database or (folder / DATABASE).is_file()):
        raise StepNcError(f"{folder}: not a data folder of the service; name it with --data")
    return open_data_folder(folder, files=options.files, database=database)


def _create(options: argparse.Namespace) -> int:
    from service.storage import keys
    from service.storage.keys import Role
    from service.terminal import tell, write_out
    from stepnc_model.errors import StepNcError

    if not options.who.strip():
        raise StepNcError("--for is empty: name the owner of the key")
    roles = frozenset(Role(word) for word in options.role)
    write_out(keys.create(_data_folder(options, is_made=True), name=options.who, roles=roles))
    tell("store this key, it is not shown again; send it as  Authorization: Bearer …")
    return OK


def _list(options: argparse.Namespace) -> int:
    from service.rendering.columns import Column
    from service.rendering.text import print_table
    from service.storage import keys

    columns: tuple[Column[keys.Key], ...] = (
        Column(heading="id", value=lambda key: key.id),
        Column(heading="for", value=lambda key: key.name),
        Column(heading="roles", value=lambda key: sorted(key.roles)),
        Column(heading="created", value=lambda key: _day(key.created)),
        Column(
            heading="state",
            value=lambda key: (
                "valid" if key.revoked is None else f"revoked {_day(key.revoked)}"
            ),
        ),
    )
    print_table(columns, keys.listed(_data_folder(options)))
    return OK


def _day(seconds: float) -> str:
    from datetime import UTC, datetime

    return datetime.fromtimestamp(seconds, UTC).date().isoformat()


def _revoke(options: argparse.Namespace) -> int:
    from service.storage import keys
    from service.terminal import tell

    keys.revoke(_data_folder(options), options.id)
    tell(f"revoked: {options.id}")
    return OK
