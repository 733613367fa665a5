"""File names of NC code."""

from pathlib import Path

from stepnc_model.post.dialect import SUFFIXES, Dialect

NC_SUFFIXES = frozenset({
    *(suffix for control, suffix in SUFFIXES.items() if control is not Dialect.CANONICAL),
    *{".spf", ".tap", ".cnc", ".gcode", ".eia", ".iso", ".min", ".ncc", ".gc", ".g"},
})
"""File name extensions of NC code."""


def is_code(path: Path) -> bool:
    """Whether a file name is one of NC code."""
    return path.suffix.lower() in NC_SUFFIXES
