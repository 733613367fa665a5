"""Store of files behind a URL, such as a bucket of objects, that several hosts share.

The only home of fsspec. Each host keeps copies below its data folder, under the same names:
files that are never changed once they are there (programs, uploads, results of an attempt) are
copied when they are first read; the small files of the library are compared with the store.
Running state.
"""

import os
import secrets
import shutil
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO

from service.errors import Unavailable
from service.optional_packages import how_to_install
from stepnc_model.errors import StepNcError

FRESH = 1.0
"""Time for which a folder is not compared with the store again, in s."""

VERSION = ("ETag", "etag", "LastModified", "last_modified", "mtime", "updated", "created")
"""Details of a file that change with its content, by the names that stores give them."""

ATTEMPTS = 2
"""Number of times that a request to a store of objects is sent, where nothing else is set."""

S3 = {"connect_timeout": 3, "read_timeout": 5, "retries": {"total_max_attempts": 1}}
"""Settings of the client for ``s3://``, in s, where the configuration of fsspec has no others:
with its own, a bucket that falls silent would keep a request waiting for minutes."""

PRIVATE = frozenset({"memory"})
"""Protocols whose files no other process sees."""


def is_store(files: str) -> bool:
    """True if a location of files is a URL instead of a folder."""
    return "://" in files


class FileStore:
    """Files behind a URL, and their copies below a folder of this host. Running state.

    Parameters
    ----------
    url : str
        Location that fsspec understands, such as ``s3://bucket/folder``.
    folder : Path
        Folder of the copies.

    Raises
    ------
    Unavailable
        When the URL is none, or the package that its protocol needs is not installed.
    """

    def __init__(self, url: str, folder: Path) -> None:
        self.folder = folder
        self.protocol = url.partition("://")[0].lower()
        self._system, self._base = _system(url)
        self._compared: dict[str, float] = {}
        self._versions: dict[str, object] = {}

    @property
    def is_private(self) -> bool:
        """True if other processes do not see the files."""
        return self.protocol in PRIVATE

    def read(self, name: str) -> bytes | None:
        """Return the content of a file; None if there is none."""
        with self._answering():
            try:
                found: bytes = self._system.cat_file(f"{self._base}/{name}")
            except FileNotFoundError:
                return None
        return found

    def publish(self, path: Path) -> None:
        """Copy a file of this host to the store, where it appears whole.

        Raises
        ------
        Unavailable
            When the store does not answer, or refuses.
        """
        with self._answering(), path.open("rb") as source:
            self._write(self._name(path), source)

    def publish_folder(self, folder: Path) -> None:
        """Copy all files below a folder, except hidden ones; errors as :meth:`publish`."""
        for path in sorted(folder.rglob("*")):
            if path.is_file() and not path.name.startswith("."):
                self.publish(path)

    def fetch(self, path: Path) -> None:
        """Copy a file here, unless it is here or the store has none.

        Raises
        ------
        Unavailable
            When the store does not answer.
        """
        if not path.is_file():
            with self._answering():
                self._fetch(path)

    def remove(self, path: Path) -> None:
        """Delete a file, or a folder with its files, from the store; nothing if it has none."""
        with self._answering():
            self._system.invalidate_cache()
            try:
                self._system.rm(f"{self._base}/{self._name(path)}", recursive=True)
            except FileNotFoundError:
                return

    def mirror(self, folder: Path, *, at_once: bool = False) -> None:
        """Make a flat folder of this host equal to that of the store; its lock must be held.

        Parameters
        ----------
        at_once : bool
            Also if it was compared a moment ago.
        """
        now, name = time.monotonic(), self._name(folder)
        if not at_once and now - self._compared.get(name, -FRESH) < FRESH:
            return
        with self._answering():
            found = self._versions_in(name)
            for path in folder.iterdir():
                # Hidden ones are the lock, and files that are being written.
                if path.name not in found and not path.name.startswith("."):
                    path.unlink(missing_ok=True)
            for each, version in found.items():
                path = folder / each
                if not path.is_file() or self._versions.get(f"{name}/{each}") != version:
                    self._fetch(path)
                    self._versions[f"{name}/{each}"] = version
        self._compared[name] = now

    def _versions_in(self, name: str) -> dict[str, object]:
        """Versions of the files in a folder of the store, by name."""
        self._system.invalidate_cache()
        try:
            rows = self._system.ls(f"{self._base}/{name}", detail=True)
        except FileNotFoundError:
            return {}
        return {
            row["name"].rpartition("/")[2]: (
                row["size"], *(str(row.get(key)) for key in VERSION)
            )
            for row in rows if row["type"] == "file"
        }  # fmt: skip

    def _fetch(self, path: Path) -> None:
        """Copy a file here, where it appears whole."""
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        partial = path.with_name(f".{secrets.token_hex(8)}")
        try:
            self._system.get_file(f"{self._base}/{self._name(path)}", str(partial))
            os.replace(partial, path)
        except FileNotFoundError:
            return
        finally:
            partial.unlink(missing_ok=True)

    def _write(self, name: str, source: BinaryIO) -> None:
        target = f"{self._base}/{name}"
        self._system.makedirs(target.rpartition("/")[0], exist_ok=True)
        file = self._system.open(target, "wb", autocommit=False)
        try:
            with file:
                shutil.copyfileobj(source, file, 1 << 20)
        except BaseException:
            file.discard()
            raise
        file.commit()

    def _name(self, path: Path) -> str:
        return path.relative_to(self.folder).as_posix()

    @contextmanager
    def _answering(self) -> Iterator[None]:
        """Convert errors; the address is for the log, not for clients."""
        try:
            yield
        except StepNcError:
            raise
        except OSError as error:
            why = error.strerror or type(error).__name__
            raise Unavailable(f"the store of files does not answer: {why}") from error
        except Exception as error:
            # Clients of stores have errors of their own; those of Python are our faults.
            if type(error).__module__ == "builtins":
                raise
            why = type(error).__name__
            raise Unavailable(f"the store of files does not answer: {why}") from error


def _system(url: str) -> tuple[Any, str]:
    """Return the file system of a URL, and the path of its folder in it."""
    shown = f"--files {url.partition('://')[0]}://…"
    try:
        from fsspec.config import conf  # noqa: PLC0415 (few use it)
        from fsspec.core import url_to_fs  # noqa: PLC0415
    except ImportError as error:
        raise Unavailable(
            f"{shown} needs the package fsspec: {how_to_install('fsspec')}"
        ) from error
    try:
        options = _options(url, conf)
        system, base = url_to_fs(url, **options)
    except (ImportError, ValueError) as error:
        raise Unavailable(f"{shown}: {error}") from error
    if options:
        system.retries = ATTEMPTS
    return system, base.rstrip("/")


def _options(url: str, configured: Mapping[str, Any]) -> dict[str, Any]:
    """Return options of the client of a store that bound the time of its answers."""
    if url.partition("://")[0].lower() not in {"s3", "s3a"}:
        return {}
    own = configured.get("s3", {}).get("config_kwargs", {})
    return {"config_kwargs": {**S3, **own}}
