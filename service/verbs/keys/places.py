"""Places of the service: its data folder, database and files."""

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from service.knowledge.place import usual_file
from service.requests.fields import About, Request
from stepnc_model.errors import StepNcError

if TYPE_CHECKING:
    from service.storage.folder import DataFolder

VARIABLE = "STEPNC_DATA"
"""Environment variable that names the data folder."""

DATABASE_VARIABLE = "STEPNC_DATABASE"
"""Environment variable that names the database; not shown to other users, unlike arguments."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ServiceFiles(Request):
    """Places of the service."""

    data: Annotated[
        Path | None,
        About(
            "data folder (default: $STEPNC_DATA, else ~/.local/share/stepnc/service)",
            flag="--data", metavar="DIR",
        ),
    ] = None  # fmt: skip
    database: Annotated[
        str,
        About(
            "postgresql://USER@HOST/DATABASE that several hosts share (default: "
            "$STEPNC_DATABASE, else a file in --data)",
            flag="--database", metavar="URL",
        ),
    ] = ""  # fmt: skip
    files: Annotated[
        str,
        About(
            "folder of programs and results, or s3://… or another URL of fsspec, shared by the "
            "hosts of one --database (default: --data)",
            flag="--files", metavar="PLACE",
        ),
    ] = ""  # fmt: skip

    @property
    def folder(self) -> Path:
        """The data folder: as named, from the environment, or the default one."""
        named = self.data or os.environ.get(VARIABLE)
        return Path(named) if named else usual_file().with_name("service")

    @property
    def database_url(self) -> str:
        """Address of the database; empty: a file in the data folder."""
        return self.database or os.environ.get(DATABASE_VARIABLE, "")

    def opened(self, *, is_made: bool = False) -> "DataFolder":
        """Open the data folder, which must exist unless it is made.

        Raises
        ------
        StepNcError
            When it does not exist or cannot be opened.
        """
        from service.storage.folder import DATABASE, open_data_folder  # noqa: PLC0415 (slow)

        folder, database = self.folder, self.database_url
        if not (is_made or database or (folder / DATABASE).is_file()):
            raise StepNcError(
                f"{folder}: not a data folder of the service; name it with --data"
            )
        return open_data_folder(folder, files=self.files, database=database)
