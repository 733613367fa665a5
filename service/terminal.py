"""Output to the user's terminal."""

import os
import sys

_CONTROLS = {
    code: "�" for code in (*range(0x20), *range(0x7F, 0xA0)) if chr(code) not in "\n\t"
}
"""Control characters (C0 and C1, except line feed and tab) and their replacement."""


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
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, open("/dev/null", "w", encoding="utf-8"))  # noqa: SIM115
        elif hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")
