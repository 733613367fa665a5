"""Which tests of a run by several workers go to the same one.

What takes long and is shared, such as a server or a plan, is made by one worker only then.
"""

from typing import Any

import pytest
from xdist.scheduler import LoadFileScheduling

ONE_SERVER = ("tests/service/rest/", "tests/service/jobs/", "tests/service/dashboard/")
"""folders whose files share a server and what it has done"""

OWN_SERVERS = ("test_serve.py", "test_runner.py")
"""files there that start their own"""


def group_of(nodeid: str) -> str:
    """Name of the group of a test: its file, or the folder of a shared server."""
    file = nodeid.partition("::")[0]
    if not file.endswith(OWN_SERVERS):
        for folder in ONE_SERVER:
            if file.startswith(folder):
                return folder
    return file


def scheduler(config: pytest.Config, log: Any) -> Any:
    """That of ``--dist loadfile``, with these groups."""
    made = LoadFileScheduling(config, log)
    made._split_scope = group_of
    return made
