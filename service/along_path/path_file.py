"""STEP-NC file with the feeds along the paths, as explicit tool paths."""

from dataclasses import dataclass
from pathlib import Path

from service.along_path.course import BlockLog
from service.along_path.run import FeedsAlongPath
from service.programs.toolpaths import paths_of, with_feeds
from stepnc_model.editing.file_profile import FileProfile
from stepnc_model.errors import Finding
from stepnc_model.post.neutral import blocks_of
from stepnc_model.post.planned_paths import planned_paths
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.explicit.path_writer import write_paths


@dataclass(frozen=True, slots=True, kw_only=True)
class PathFile:
    """Program file with explicit tool paths."""

    data: bytes
    count: int
    """Number of workingsteps whose tool path was written."""
    findings: tuple[Finding, ...]
    """Reasons why tool paths of other workingsteps were not written."""


def with_tool_paths(program: Program, along: FeedsAlongPath, profile: FileProfile) -> PathFile:
    """Write the tool paths of a program at the planned feeds into its file.

    Parameters
    ----------
    program : Program
        The program that was planned.

    Raises
    ------
    StepNcError
        When a tool path cannot be generated.
    """
    items = with_feeds(paths_of(program), keep_going=False).items
    blocks = blocks_of(program, items, name=Path(program.name).stem)
    found = planned_paths(program, items, BlockLog((0, block) for block in blocks), along.feeds)
    return PathFile(
        data=write_paths(program, found.paths, profile),
        count=len(found.paths),
        findings=found.findings,
    )
