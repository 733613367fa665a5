"""Members of ZIP archives, unpacked within a budget of bytes.

The directory of an archive may state any size, and :meth:`zipfile.ZipFile.read` unpacks what
it finds before it compares. Here as much is unpacked as the budget allows, whatever the
directory states. Methods whose library unpacks without a bound are refused.
"""

import struct
import zlib
from collections.abc import Iterator
from copy import copy
from zipfile import ZIP_DEFLATED, ZIP_STORED, BadZipFile, ZipFile, ZipInfo

DAMAGES = (
    BadZipFile,
    EOFError,
    IndexError,
    NotImplementedError,
    OSError,
    RuntimeError,
    ValueError,
    struct.error,
    zlib.error,
)
"""What the standard library raises for a damaged archive, depending on where it is damaged."""

METHODS = (ZIP_STORED, ZIP_DEFLATED)
"""Methods that are unpacked; of others :mod:`zipfile` cannot bound what comes out."""

CHUNK = 1 << 16
"""Bytes that are unpacked at a time."""


def member_chunks(archive: ZipFile, member: ZipInfo, *, most: int) -> Iterator[bytes]:
    """Yield the content of a member in pieces.

    Parameters
    ----------
    most : int
        Greatest length of the content, bytes.

    Raises
    ------
    BadZipFile
        When the member is neither stored nor deflated, becomes longer, or is not of the size
        that the directory states.
    """
    if member.compress_type not in METHODS:
        raise BadZipFile(f"'{member.filename}' is neither stored nor deflated")
    whole = copy(member)
    # The library cuts the content off at the size of the directory, after it was unpacked.
    whole.file_size = most + 1
    size = 0
    with archive.open(whole) as file:
        while chunk := file.read(min(CHUNK, most + 1 - size)):
            size += len(chunk)
            if size > most:
                raise BadZipFile(f"'{member.filename}' unpacks to more than {most} bytes")
            yield chunk
    if size != member.file_size:
        raise BadZipFile(
            f"'{member.filename}' unpacks to {size} bytes, but the directory states "
            f"{member.file_size}"
        )


def read_member(archive: ZipFile, member: ZipInfo, *, most: int) -> bytes:
    """Content of a member.

    Raises
    ------
    BadZipFile
        As :func:`member_chunks`.
    """
    return b"".join(member_chunks(archive, member, most=most))


def require_sizes(archive: ZipFile, *, most: int) -> None:
    """Unpack all members once, piece by piece, for a library that will not bound them.

    Parameters
    ----------
    most : int
        Greatest length of all members together, bytes.

    Raises
    ------
    BadZipFile
        As :func:`member_chunks`.
    """
    for member in archive.infolist():
        for chunk in member_chunks(archive, member, most=most):
            most -= len(chunk)
