"""``stepnc dataset``: many parts on the virtual machine, by a design of experiments."""

import argparse
from pathlib import Path

from service.cli.options import OK, Commands, add_cluster


def add_dataset_command(commands: Commands) -> None:
    """Add it to ``stepnc``."""
    parser = commands.add_parser(
        "dataset", help="run parts by a design of experiments, as Parquet for learning"
    )
    add = parser.add_argument
    add("design", type=Path, metavar="DESIGN", help="design file, .toml")
    add(
        "-n",
        "--rows",
        type=int,
        metavar="ROWS",
        help="number of rows (default: all combinations of a full factorial)",
    )
    add(
        "-o",
        "--output",
        type=Path,
        required=True,
        metavar="FOLDER",
        help="folder of the data set; rows that are there are kept",
    )
    add("--csv", action="store_true", help="write FOLDER/data.csv as well")
    add(
        "--programs",
        action="store_true",
        help="write the STEP-NC program of each row as FOLDER/programs/row-NNNNNN.stpnc",
    )
    add_cluster(parser)
    parser.set_defaults(run=_dataset)


def _dataset(options: argparse.Namespace) -> int:
    """Run the command ``stepnc dataset``."""
    from service.dataset.folder import PROGRAMS
    from service.dataset.run import DatasetFiles, make_dataset
    from service.execution.pools import pools_of
    from service.terminal import tell

    result = make_dataset(
        options.design,
        options.output,
        rows=options.rows,
        tell=tell,
        files=DatasetFiles(has_csv=options.csv, has_programs=options.programs),
        pools=pools_of(options.cluster),
    )
    tell(f"written: {result.folder} ({result.rows} rows, {result.made} of them new)")
    if result.csv is not None:
        tell(f"CSV: {result.csv}")
    if options.programs:
        tell(f"programs: {result.folder / PROGRAMS}")
    return OK
