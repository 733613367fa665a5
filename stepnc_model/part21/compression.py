"""Compressed Part 21 files: a ZIP archive or a gzip stream, recognised by their first bytes.

How much comes out is bounded before anything is unpacked, and again while it is unpacked,
because a few kilobytes can hold gigabytes.

References
----------
.. [1] ISO 10303-21:2016, annex on ZIP archives (root file ``ISO-10303.p21``).
.. [2] RFC 1952 (gzip).
"""

import zlib
from io import BytesIO
from zipfile import ZipFile, ZipInfo

from stepnc_model.errors import Part21Error
from stepnc_model.zip_member import DAMAGES, METHODS, read_member

MAX_UNPACKED = 1 << 28
"""Greatest length of an unpacked file, bytes."""
MAX_MEMBERS = 1000
"""Greatest number of files in an archive."""
ROOT = "iso-10303.p21"
"""Name of the root file of an archive, in lower case."""

_ZIP = (b"PK\x03\x04", b"PK\x05\x06")
"""First bytes of an archive, and of one without files."""
_GZIP = b"\x1f\x8b"
_GZIP_WINDOW = 16 + zlib.MAX_WBITS
_OPENING = b"ISO-10303-21"
_PEEKED = 4096
"""Bytes of a member within which the opening of a Part 21 file is looked for."""


def unpacked(data: bytes) -> bytes:
    """Bytes of the Part 21 file in an archive; other bytes are returned unchanged.

    Parameters
    ----------
    data : bytes

    Returns
    -------
    bytes

    Raises
    ------
    Part21Error
        If the archive is damaged, holds no Part 21 file or several, is encrypted, or would
        become longer than ``MAX_UNPACKED``.
    """
    if data.startswith(_ZIP):
        return _from_zip(data)
    if data.startswith(_GZIP):
        return _from_gzip(data)
    return data


def _from_gzip(data: bytes) -> bytes:
    """Unpack a gzip stream, which may consist of several members."""
    pieces: list[bytes] = []
    left = MAX_UNPACKED + 1
    while data.startswith(_GZIP) and left > 0:
        stream = zlib.decompressobj(_GZIP_WINDOW)
        try:
            piece = stream.decompress(data, left)
        except zlib.error as error:
            raise Part21Error(f"the gzip stream is damaged: {error}") from error
        pieces.append(piece)
        left -= len(piece)
        if left > 0 and not stream.eof:
            raise Part21Error("the gzip stream breaks off")
        data = stream.unused_data
    if left <= 0:
        raise _too_long()
    return b"".join(pieces)


def _from_zip(data: bytes) -> bytes:
    """Unpack the Part 21 file of an archive."""
    try:
        with ZipFile(BytesIO(data)) as archive:
            return _read(archive, _member(archive))
    except DAMAGES as error:
        raise Part21Error(f"the ZIP archive cannot be read: {error}") from error


def _member(archive: ZipFile) -> ZipInfo:
    """The root file, or else the only Part 21 file of an archive."""
    members = [each for each in archive.infolist() if not each.is_dir()]
    if len(members) > MAX_MEMBERS:
        message = f"the ZIP archive holds {len(members)} files; at most {MAX_MEMBERS} are read"
        raise Part21Error(message)
    for each in members:
        if each.flag_bits & 1:
            raise Part21Error(f"'{each.filename}' in the ZIP archive is encrypted")
        if each.compress_type not in METHODS:
            message = f"'{each.filename}' in the ZIP archive is neither stored nor deflated"
            raise Part21Error(message)
    roots = [each for each in members if each.filename.lower() == ROOT]
    found = roots or [each for each in members if _OPENING in _beginning(archive, each)]
    if len(found) != 1:
        count = len(found) or "no"
        raise Part21Error(f"the ZIP archive holds {count} Part 21 files instead of one")
    return found[0]


def _read(archive: ZipFile, member: ZipInfo) -> bytes:
    """Read a file of an archive."""
    if member.file_size > MAX_UNPACKED:
        raise _too_long()
    return read_member(archive, member, most=member.file_size)


def _beginning(archive: ZipFile, member: ZipInfo) -> bytes:
    """Beginning of a file of an archive, in capitals."""
    with archive.open(member) as file:
        return file.read(_PEEKED).upper()


def _too_long() -> Part21Error:
    """Error about an archive that unpacks to too much."""
    return Part21Error(f"the archive unpacks to more than {MAX_UNPACKED >> 20} MB")
