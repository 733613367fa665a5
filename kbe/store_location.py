"""Location of a knowledge base: a file, or a server database shown without its password."""

import os
from dataclasses import dataclass
from urllib.parse import quote, urlsplit

from sqlalchemy.engine import URL, make_url
from sqlalchemy.exc import ArgumentError

from kbe.errors import StoreUnavailable

FORMS = "name a file, or sqlite:///FILE, or postgresql://USER@HOST/DATABASE"


@dataclass(frozen=True, slots=True, kw_only=True)
class StoreLocation:
    """Location of a knowledge base."""

    url: URL
    shown: str
    """Text shown to people, without a password."""
    file: str
    """Path of the file; empty for a server."""
    is_immutable: bool = False
    """Whether the file is read as it is, since nothing can be written beside it."""

    @property
    def reading_address(self) -> str:
        """Address of the file for SQLite, by which nothing is written into it."""
        how = "mode=ro&immutable=1" if self.is_immutable else "mode=ro"
        return f"file:{quote(os.path.abspath(self.file))}?{how}"


def parsed_place(url_or_path: str) -> StoreLocation:
    """Parse the location that a user named.

    Raises
    ------
    StoreUnavailable
        When it is not a valid location; a possible password is not repeated.
    """
    if "://" not in url_or_path:
        return _file(url_or_path)
    scheme, _, rest = url_or_path.partition("://")
    kind = scheme.lower().partition("+")[0]
    if kind == "sqlite":
        return _file(rest.removeprefix("/"))
    if kind not in {"postgresql", "postgres"}:
        raise StoreUnavailable(f"{scheme}://…", reason=f"unknown kind of database; {FORMS}")
    return _server(rest)


def _file(name: str) -> StoreLocation:
    """Location of an SQLite file."""
    if not name or name == ":memory:" or "\0" in name:
        raise StoreUnavailable(repr(name), reason=f"is not a file name; {FORMS}")
    # SQLite would interpret such a name as an address with options.
    path = f"./{name}" if name.startswith("file:") else name
    return StoreLocation(
        url=URL.create("sqlite+pysqlite", database=path), shown=name, file=path
    )


def _server(rest: str) -> StoreLocation:
    """Location of a PostgreSQL database."""
    url = _server_url(rest)
    name = f"{url.username}@" if url.username else ""
    # A socket or host, and also a password, may be given in the query string.
    host = url.host or ",".join(url.normalized_query.get("host", ()))
    port = f":{url.port}" if url.port else ""
    shown = f"postgresql://{name}{host}{port}/{url.database or ''}"
    return StoreLocation(url=url, shown=shown, file="")


def _server_url(rest: str) -> URL:
    """Parse the address of a server, if it is certain which part is the password."""
    try:
        address = urlsplit(f"postgresql://{rest}")
        beyond = address.path + address.query + address.fragment
        is_clear = address.netloc.count("@") <= 1 and "@" not in beyond
        if is_clear and not address.fragment:
            return make_url(f"postgresql+psycopg://{rest}")
    except (ArgumentError, ValueError):
        pass
    reason = (
        "is not a valid address; write postgresql://USER:PASSWORD@HOST:PORT/DATABASE, "
        "with %40 for @, %2F for /, %3A for :, %23 for # and %3F for ? in the password"
    )
    # The original error could reveal a password.
    raise StoreUnavailable("postgresql://…", reason=reason) from None


def require_openable(place: StoreLocation, *, is_new_allowed: bool) -> None:
    """Refuse a file that cannot be a store, before SQLite creates one.

    Raises
    ------
    StoreUnavailable
        With what to do.
    """
    path, shown = place.file, place.shown
    if not path:
        return
    if os.path.exists(path):
        if not os.path.isfile(path):
            raise StoreUnavailable(shown, reason=f"is not a file; {FORMS}")
        return
    if not os.path.isdir(os.path.dirname(path) or "."):
        raise StoreUnavailable(shown, reason="the folder does not exist; create it first")
    if not is_new_allowed:
        raise StoreUnavailable(shown, reason="there is no such file; check the name")
