"""Routes of the dashboard's files, and of plotly.js from the installed package."""

import gzip
import hashlib
from functools import cache
from pathlib import Path

from fastapi import APIRouter, Request, Response
from fastapi.responses import RedirectResponse
from starlette.concurrency import run_in_threadpool

from service.errors import NotFound
from service.rest.replies import matches

ROUTES = APIRouter(include_in_schema=False)

FOLDER = Path(__file__).parents[1] / "dashboard"

KINDS = {
    ".html": "text/html; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".svg": "image/svg+xml",
}


SITE, DOCS = (Path(__file__).parents[2] / name for name in ("build/site", "docs"))
"""Manual as a site that ``make docs`` has built, and the pages that it is built from."""

MANUAL_KINDS = KINDS | {
    ".md": "text/plain; charset=utf-8",
    ".json": "application/json",
    ".png": "image/png",
    ".woff2": "font/woff2",
}

# The theme of the manual has scripts in its pages; nothing comes from another host.
MANUAL_POLICY = (
    "default-src 'none'; script-src 'self' 'unsafe-inline'; style-src 'self' 'unsafe-inline'; "
    "img-src 'self' data:; connect-src 'self'; font-src 'self'; worker-src 'self' blob:; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)


@ROUTES.get("/")
async def root() -> Response:
    """Redirect to the first page of the dashboard."""
    return RedirectResponse("/dashboard/plan.html")


@ROUTES.get("/dashboard/plotly.min.js")
async def plotly(request: Request) -> Response:
    """Serve plotly.js from the installed package: nothing is fetched from another host."""
    content, tag = await run_in_threadpool(_plotly)
    headers = {"etag": tag, "cache-control": "public, max-age=86400", "vary": "accept-encoding"}
    if matches(request.headers.get("if-none-match"), tag):
        return Response(status_code=304, headers=headers)
    if "gzip" in request.headers.get("accept-encoding", ""):
        return Response(
            content, media_type=KINDS[".js"], headers={**headers, "content-encoding": "gzip"}
        )
    return Response(gzip.decompress(content), media_type=KINDS[".js"], headers=headers)


@ROUTES.get("/dashboard/{name}")
async def file(request: Request, name: str) -> Response:
    """Serve a file of the dashboard."""
    found = files().get(name)
    if found is None:
        raise NotFound("page", name)
    body = await run_in_threadpool(found.read_bytes)
    tag = f'"{hashlib.blake2b(body, digest_size=12).hexdigest()}"'
    headers = {"etag": tag, "cache-control": "no-cache"}
    if matches(request.headers.get("if-none-match"), tag):
        return Response(status_code=304, headers=headers)
    return Response(body, media_type=KINDS[found.suffix], headers=headers)


@ROUTES.get("/manual/{name:path}")
async def manual(request: Request, name: str) -> Response:
    """Serve the manual: the built site, or without it the pages that it is built from."""
    found = await run_in_threadpool(_manual, name)
    if found is None:
        raise NotFound("page of the manual (it is in the folder docs of the project)", name)
    body = await run_in_threadpool(found.read_bytes)
    tag = f'"{hashlib.blake2b(body, digest_size=12).hexdigest()}"'
    headers = {"etag": tag, "cache-control": "no-cache"}
    if matches(request.headers.get("if-none-match"), tag):
        return Response(status_code=304, headers=headers)
    if found.suffix == ".html":
        headers["content-security-policy"] = MANUAL_POLICY
    kind = MANUAL_KINDS.get(found.suffix, "application/octet-stream")
    return Response(body, media_type=kind, headers=headers)


def _manual(name: str) -> Path | None:
    """Path of a file of the manual; None if there is no such file in its folder."""
    for folder, path in (
        (SITE, name),
        (DOCS, name.removesuffix(".html") + ".md"),
        (DOCS, name),
    ):
        found = (folder / path).resolve()
        if found.is_relative_to(folder.resolve()) and found.is_file():
            return found if found.suffix in MANUAL_KINDS else None
    return None


@ROUTES.get("/favicon.ico")
async def favicon() -> Response:
    """Serve the icon that browsers request by default."""
    return RedirectResponse("/dashboard/icon.svg")


@cache
def files() -> dict[str, Path]:
    """Return the paths of the dashboard's files by file name."""
    return {path.name: path for path in FOLDER.iterdir() if path.suffix in KINDS}


@cache
def _plotly() -> tuple[bytes, str]:
    """Return plotly.js compressed with gzip, and its entity tag; computed once."""
    from plotly.offline import get_plotlyjs  # noqa: PLC0415 (plotly takes a second)

    text = get_plotlyjs().encode()
    tag = f'"{hashlib.blake2b(text, digest_size=12).hexdigest()}"'
    return gzip.compress(text, 6, mtime=0), tag
