"""An attack in a process of its own, with little memory and processor time."""

import subprocess
import sys
from pathlib import Path

MIB = 1 << 20

HEAD = """
import resource, sys
from pathlib import Path
{imports}
from stepnc_model.errors import StepNcError
for kind, most in ((resource.RLIMIT_AS, {memory}), (resource.RLIMIT_CPU, {seconds})):
    resource.setrlimit(kind, (most, most))
for place in sys.argv[1:]:
    path = Path(place)
    try:
        {words}
    except StepNcError as error:
        print(error)
    else:
        print("accepted", place)
"""


def refusals(
    words: str, paths: list[Path], *, imports: str, memory: int, seconds: int = 60
) -> list[str]:
    """What is said to each of some files; the process fails where it exceeds its limits.

    Parameters
    ----------
    words : str
        Statement that reads the file ``path``.
    paths : list of Path
    imports : str
        Imports, which do not count as processor time of the attack alone.
    memory : int
        Address space, MiB, with all libraries.
    seconds : int
        Processor time, s, with all imports.
    """
    text = HEAD.format(imports=imports, memory=memory * MIB, seconds=seconds, words=words)
    done = subprocess.run(
        [sys.executable, "-c", text, *map(str, paths)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, (done.returncode, done.stderr[-500:])
    return done.stdout.splitlines()
