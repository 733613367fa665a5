"""Files of a verb whose result is written as a whole, in a format that is asked for."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from service.outputs.output_format import OutputFormat, format_of
from service.requests.fields import About, FileUse, Request
from stepnc_model.errors import StepNcError

Format = Annotated[
    OutputFormat | None,
    About(
        "text, csv, json, html or parquet (default: by the file extension; text on stdout)",
        flag="--format", metavar="FORMAT",
    ),
]  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class OutputFiles(Request):
    """File of a result, and its format; the doors print or write it."""

    output: Annotated[
        Path | None,
        About(
            "output file (default: stdout)",
            flag="--output", short="-o", use=FileUse.OUTPUT, metavar="FILE",
        ),
    ] = None  # fmt: skip
    format: Format = None

    @property
    def is_printed(self) -> bool:
        """True if the result is printed in a format that is asked for."""
        return self.output is None and self.format is not None

    def require_format(self) -> None:
        """Refuse a name that tells no format, and Parquet without a file.

        Raises
        ------
        StepNcError
            Before anything is read.
        """
        if self.output is not None and self.format is None:
            format_of(self.output)
        if self.output is None and self.format is OutputFormat.PARQUET:
            raise StepNcError("Parquet cannot be printed; name a file with -o FILE.parquet")
