"""A file that is written bit by bit, and gets its name when it is whole.

What is broken off is left as ``.partial``, closed and readable.
"""

import os
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from stepnc_model.errors import WriteError


class GrowingFile:
    """File under a temporary name. Running state.

    Raises
    ------
    WriteError
        When the disk refuses.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.place: Path | None = None
        """Name of the file once it is closed."""
        try:
            descriptor, self._name = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
            self.stream = os.fdopen(descriptor, "wb")
        except OSError as error:
            raise self.refused(error) from error

    @property
    def partial(self) -> Path:
        """Name of the file that an interrupted run leaves."""
        return self.path.with_suffix(f".partial{self.path.suffix}")

    @contextmanager
    def closing(
        self, *, is_whole: bool, has_content: Callable[[], bool] = lambda: True
    ) -> Iterator[None]:
        """Write the last bytes within it; then the file gets its name, or is left as partial.

        A file without content is left only when it is whole.

        Raises
        ------
        WriteError
            When the disk refuses; nothing is left.
        """
        try:
            yield
            self.stream.flush()
            os.fsync(self.stream.fileno())
            if is_whole or has_content():
                place = self.path if is_whole else self.partial
                os.chmod(self._name, _mode(place))
                os.replace(self._name, place)
                self.place = place
        except OSError as failure:
            raise self.refused(failure) from failure
        finally:
            # What the disk has refused once it refuses again.
            with suppress(OSError):
                self.stream.close()
            Path(self._name).unlink(missing_ok=True)

    def refused(self, error: OSError) -> WriteError:
        """Error for what the disk refused."""
        return WriteError(error.strerror or str(error), path=str(self.path))


def _mode(place: Path) -> int:
    """Permissions of the file that is replaced, or what a new file gets."""
    if place.exists():
        return place.stat().st_mode & 0o777
    umask = os.umask(0)
    os.umask(umask)
    return 0o666 & ~umask
