"""The jobs ``trial`` and ``control-run``: runs that people watch and change while they go on."""

from service.jobs.task import Task


def run(task: Task) -> None:
    """Run until the end, or until somebody ends it."""
    raise NotImplementedError
