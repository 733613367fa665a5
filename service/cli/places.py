"""Places of a command's files: no output takes the place of another file of the command."""

import argparse
from collections.abc import Iterator
from pathlib import Path

from service.files import require_distinct


def require_own_places(options: argparse.Namespace) -> None:
    """Refuse a command of which two outputs, or an output and an input, are the same file.

    Outputs are the arguments of type :func:`service.cli.options.output_path`. Inputs are all
    others that name a file: a machine or a stock is typed as text, and may be a file.

    Raises
    ------
    WriteError
        Before anything is read or written.
    """
    names = getattr(options, "output_names", ())
    # A command with --in-place names it where the output is its file.
    own = {"output", "file"} if hasattr(options, "in_place") else set()
    outputs = {name: getattr(options, name) for name in names}
    inputs = {
        name: list(_files(value))
        for name, value in vars(options).items()
        if name not in outputs and name not in {"output_names", "flags"}
    }
    require_distinct(outputs.values())
    for name, place in outputs.items():
        read = (
            each for other, files in inputs.items() if {name, other} != own for each in files
        )
        require_distinct([place], apart_from=read)


def _files(value: object) -> Iterator[Path]:
    """Files that the value of an argument names."""
    if isinstance(value, Path):
        yield value
    elif isinstance(value, (list, tuple)):
        for each in value:
            yield from _files(each)
    elif isinstance(value, str):
        # The solid of a STEP file follows its name: part.step#SOLID.
        for name in {value, value.partition("#")[0]}:
            if name and _is_file(name):
                yield Path(name)


def _is_file(name: str) -> bool:
    try:
        return Path(name).is_file()
    except (OSError, ValueError):  # a long text, or one with a null character
        return False
