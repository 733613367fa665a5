"""Output to the user's terminal."""

import sys

_CONTROLS = {
    code: "�" for code in (*range(0x20), *range(0x7F, 0xA0)) if chr(code) not in "\n\t"
}
"""C0 and C1 control characters but line breaks and tabs"""


def write_out(text: str) -> None:
    """A line of data, to stdout."""
    sys.stdout.write(clean(text) + "\n")


def tell(message: str) -> None:
    """A line of progress or an error, to stderr."""
    sys.stderr.write(clean(message) + "\n")


def clean(text: str) -> str:
    """Text whose control characters, which a file may hold, cannot steer a terminal."""
    return text.translate(_CONTROLS)


def prepare() -> None:
    """Make both streams writable in any locale, also where the shell closed them."""
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, open("/dev/null", "w", encoding="utf-8"))  # noqa: SIM115
        elif hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")
