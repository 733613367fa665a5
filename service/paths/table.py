"""Tool paths as a table on a terminal."""

from service.paths.toolpaths import Paths
from service.tables import print_findings, print_line, print_table
from stepnc_model.toolpath.function import Function
from stepnc_model.toolpath.path import MoveType, ToolPath, length


def print_paths(paths: Paths) -> None:
    """A row for each tool path, then what was assumed."""
    header = (
        "workingstep", "operation", "tool", "moves", "arcs", "contact mm", "air mm",
        "rapid mm", "lowest z",
    )  # fmt: skip
    print_line(f"{paths.program.name}: {len(paths.paths)} tool paths")
    print_table(header, [_row(paths, item) for item in paths.items])
    print_findings(paths.findings)


def _row(paths: Paths, item: ToolPath | Function) -> tuple[str, ...]:
    """One tool path, or a stop between two."""
    if isinstance(item, Function):
        return (item.id, item.keyword.lower(), *[""] * 7)
    contact = air = rapid = 0.0
    for start, move in item.segments():
        size = length(start, move)
        if move.feed is None:
            rapid += size
        elif move.type is MoveType.CONTACT:
            contact += size
        else:
            air += size
    program = paths.program
    tool = program.get(item.tool_ref) if item.tool_ref is not None else None
    return (
        item.id,
        program.file.keyword(int(item.operation_ref)).lower(),
        getattr(tool, "its_id", ""),
        str(len(item.moves)),
        str(sum(move.arc is not None for move in item.moves)),
        f"{contact:.0f}",
        f"{air:.0f}",
        f"{rapid:.0f}",
        f"{min((move.end[2] for move in item.moves), default=item.start[2]):g}",
    )
