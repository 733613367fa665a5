"""Which tests of a run by several workers go to the same one, and which begin first.

What takes long and is shared, such as a server or a plan, is made by one worker only then.
"""

from typing import Any

from xdist.scheduler import LoadFileScheduling

ONE_SERVER = ("tests/service/rest/", "tests/service/jobs/", "tests/service/dashboard/")
"""folders whose files share a server and what it has done"""

OWN_SERVERS = (
    "test_runner.py",
    "test_serve.py",
    "test_serve_database.py",
    "test_serve_store.py",
    "test_two_hosts.py",
)
"""files there that start their own"""

LONGEST = (
    # A real control runs by the clock, and leaves the cores to the other workers.
    "tests/extras/linuxcnc/test_samples.py",
    "tests/extras/linuxcnc/test_bench.py",
    "tests/service/rest/",
    "tests/service/rest/test_serve_database.py",
    "tests/service/rest/test_serve.py",
    "tests/service/jobs/test_two_hosts.py",
    "tests/service/rest/test_serve_store.py",
    "tests/docs/test_service_page.py",
    "tests/properties/test_pocket_paths.py",
    "tests/benchmarks/test_spiral.py",
    "tests/service/test_every_missing_instance.py",
    "tests/service/along_path/test_output.py",
)
"""groups that take most of a minute or more though their tests are few, the longest first"""


def group_of(nodeid: str) -> str:
    """Name of the group of a test: its file, or the folder of a shared server."""
    file = nodeid.partition("::")[0]
    if not file.endswith(OWN_SERVERS):
        for folder in ONE_SERVER:
            if file.startswith(folder):
                return folder
    return file


class LongestFirst(LoadFileScheduling):  # type: ignore[misc]
    """Scheduler of ``--dist loadfile`` with these groups.

    It hands out the groups with most tests first. One with few but long tests would begin last,
    and all other workers would wait for it.
    """

    def _split_scope(self, nodeid: str) -> str:
        return group_of(nodeid)

    def _assign_work_unit(self, node: Any) -> None:
        for group in LONGEST:
            if group in self.workqueue:
                self.workqueue.move_to_end(group, last=False)
                break
        super()._assign_work_unit(node)
