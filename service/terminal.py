"""What goes to a person's terminal."""

import sys


def write_out(text: str) -> None:
    """A line of data, to stdout."""
    sys.stdout.write(clean(text) + "\n")


def tell(message: str) -> None:
    """A line of progress or an error, to stderr."""
    sys.stderr.write(clean(message) + "\n")


def clean(text: str) -> str:
    """Text whose control characters, which a file may hold, cannot steer a terminal."""
    return "".join(each if each.isprintable() or each == "\n" else "�" for each in text)


def prepare() -> None:
    """Make both streams writable in any locale, also where the shell closed them."""
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, open("/dev/null", "w", encoding="utf-8"))  # noqa: SIM115
        elif hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")
