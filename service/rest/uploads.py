"""Bodies of uploads: pieces as they arrive, unpacked, up to a bound."""

import asyncio
import zlib
from collections.abc import AsyncIterator

from fastapi import Request

from service.errors import TooLarge, Unreadable

PIECE = 1 << 20
"""Most bytes of one unpacked piece."""


async def pieces(request: Request, *, what: str, bound: int) -> AsyncIterator[bytes]:
    """Yield the body of a request in pieces; a gzip body is unpacked.

    Parameters
    ----------
    what : str
        Name of the content in messages.
    bound : int
        Most bytes, unpacked.

    Raises
    ------
    Unreadable, TooLarge
        When the body is packed otherwise, damaged or larger than the bound.
    """
    packing = request.headers.get("content-encoding", "identity").lower()
    if packing not in {"identity", "gzip"}:
        raise Unreadable(f"unknown Content-Encoding '{packing}'; send gzip or none")
    unpack = zlib.decompressobj(wbits=31) if packing == "gzip" else None
    size = 0
    async for chunk in request.stream():
        rest = chunk
        while rest:
            part = rest if unpack is None else _unpacked(unpack, rest, PIECE)
            rest = b"" if unpack is None else unpack.unconsumed_tail
            size += len(part)
            if size > bound:
                raise TooLarge(what, bound=bound)
            if part:
                yield part
            await asyncio.sleep(0)
    if unpack is not None and not unpack.eof:
        raise Unreadable("the gzip body is incomplete")


def _unpacked(unpack: "zlib._Decompress", chunk: bytes, most: int) -> bytes:
    """Decompress a chunk, up to a number of bytes."""
    try:
        part = unpack.decompress(chunk, most)
    except zlib.error as error:
        raise Unreadable(f"the body is not valid gzip: {error}") from error
    if unpack.unused_data:
        raise Unreadable("data follows the end of the gzip body; send a single file")
    return part
