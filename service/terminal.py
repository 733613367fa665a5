"""Output to the user's terminal."""

import errno
import io
import os
import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer

_CONTROLS = {
    code: "�" for code in (*range(0x20), *range(0x7F, 0xA0)) if chr(code) not in "\n\t"
}
"""Control characters (C0 and C1, except line feed and tab) and their replacement."""


class OutputFault(OSError):
    """Stdout cannot be written: its reader has left, or its disk is full."""

    @property
    def is_reader_gone(self) -> bool:
        """True if it is a pipe whose reader has left, as of ``| head``, which is fine."""
        return self.errno == errno.EPIPE


class OutputStream(io.FileIO):
    """Stdout, whose faults can be told from those of files and networks."""

    def write(self, data: "ReadableBuffer", /) -> int:
        """Write some bytes.

        Raises
        ------
        OutputFault
            When the system refuses them.
        """
        try:
            return super().write(data)
        except OSError as error:
            raise OutputFault(error.errno, error.strerror) from error


def write_out(text: str) -> None:
    """Write a line of data to stdout."""
    sys.stdout.write(clean(text) + "\n")


def drop_out() -> None:
    """Drop what stdout still holds, so that the end of the process does not write it."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def tell(message: str) -> None:
    """Write a progress or error message to stderr, in one line: names may contain others."""
    sys.stderr.write(clean(message).replace("\n", " ") + "\n")


def clean(text: str) -> str:
    """Replace control characters, so that text from a file cannot control the terminal."""
    return text.translate(_CONTROLS)


def prepare() -> None:
    """Make stdout and stderr writable in any locale, also when the shell closed them."""
    _name_faults_of_stdout()
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, open("/dev/null", "w", encoding="utf-8"))  # noqa: SIM115
        elif hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")


def _name_faults_of_stdout() -> None:
    """Let faults of the stdout of this process say that they are; tests have one of theirs."""
    before = sys.stdout
    if (
        before is None
        or before is not sys.__stdout__
        or not isinstance(before, io.TextIOWrapper)
    ):
        return
    raw = OutputStream(before.fileno(), "wb", closefd=False)
    sys.stdout = sys.__stdout__ = io.TextIOWrapper(  # type: ignore[misc]
        io.BufferedWriter(raw),
        encoding=before.encoding,
        errors=before.errors,
        line_buffering=before.line_buffering,
        write_through=before.write_through,
    )
