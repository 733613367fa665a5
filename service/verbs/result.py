"""Result of a verb: the base of what every verb returns."""

from collections.abc import Iterator, Sequence
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from service.errors import OK
from service.outputs.output_format import OutputFormat, format_of
from service.rendering.columns import Change, Column
from service.rendering.view import Fact, ResultView, TextLine
from stepnc_model.errors import StepNcError

if TYPE_CHECKING:
    import plotly.graph_objects as go
    import pyarrow as pa

    from service.outputs.flat_file import FileColumn, Row

WIDE = 10_000
"""Characters per line of a text that no terminal limits."""


class Result:
    """Base of the results of verbs; each declares its view, and a page if it has one."""

    __slots__ = ()

    def __init_subclass__(cls) -> None:
        # A prompt shows the text, not the fields that a dataclass would list.
        cls.__repr__ = Result.__str__  # type: ignore[assignment]

    @property
    def exit_code(self) -> int:
        """Exit code of the command line."""
        return OK

    def view(self) -> ResultView:
        """Return what the result says."""
        raise NotImplementedError

    def page(self) -> str:
        """Return a self-contained HTML page.

        Raises
        ------
        StepNcError
            When the result has no page.
        """
        raise StepNcError(f"{type(self).__name__} has no page")

    def figures(self) -> Sequence["go.Figure"]:
        """Return the figures of the page."""
        return ()

    def record(self) -> dict[str, Any]:
        """Return the result as the JSON object that ``--json`` prints."""
        return self.view().record()

    def kept(self, folder: Path) -> dict[str, Any]:
        """Write what a job keeps beside result and report; return the result of the job."""
        del folder
        return self.record()

    def table(self, key: str = "") -> "pa.Table":
        """Return a table of the result, with units in the names of its columns.

        Parameters
        ----------
        key : str
            Key of the rows in JSON; empty: the first table.

        Raises
        ------
        StepNcError
            When there is no such table.
        """
        import pyarrow as pa  # noqa: PLC0415 (an extra)

        found = self.view().table(key)
        return pa.table(dict(_columns(found.columns, found.rows)))

    def to_pandas(self, key: str = "") -> Any:
        """Return a table of the result for pandas; see :meth:`table`."""
        return self.table(key).to_pandas()

    def plot(self) -> "go.Figure":
        """Return the first figure of the result.

        Raises
        ------
        StepNcError
            When it has none.
        """
        figures = self.figures()
        if not figures:
            raise StepNcError(f"{type(self).__name__} has no figure")
        return figures[0]

    def save(self, path: str | Path, form: OutputFormat | None = None) -> Path:
        """Write the result to a file, in the format that its name ends with or another.

        Raises
        ------
        StepNcError
            When the name tells no format, or the result has no page or no table.
        """
        # Imported late, as what writes files is not needed where none is written.
        from service.files import write_atomically  # noqa: PLC0415

        place = Path(path)
        form = form or format_of(place)
        if form is OutputFormat.PARQUET:
            from service.outputs.flat_file import Format, write_rows  # noqa: PLC0415

            write_rows(place, *self._rows(), form=Format.PARQUET)
        else:
            write_atomically(place, f"{self.printed(form)}\n".encode(errors="replace"))
        return place

    def printed(self, form: OutputFormat) -> str:
        """Return the result as text of a format.

        Raises
        ------
        StepNcError
            When the result has no page or no table, or the format is not of text.
        """
        match form:
            case OutputFormat.TEXT:
                return str(self)
            case OutputFormat.JSON:
                from service.rendering.columns import dump  # noqa: PLC0415

                return dump(self.record())
            case OutputFormat.HTML:
                return self.page()
            case OutputFormat.CSV:
                from service.outputs.flat_file import csv_lines  # noqa: PLC0415

                return "\n".join(csv_lines(*self._rows()))
        raise StepNcError(f"{form.value} is not text")

    def _rows(self) -> "tuple[Sequence[FileColumn], Iterator[Row]]":
        """Columns and rows of the first table, for files."""
        from service.rendering.columns import file_columns, file_rows  # noqa: PLC0415

        found = self.view().table()
        return file_columns(found.columns), file_rows(found.columns, found.rows)

    def __str__(self) -> str:
        return "\n".join(text for text, _ in self.view().lines(width=WIDE, is_reported=False))

    def _repr_html_(self) -> str:
        """Return what notebooks show."""
        return self.view().html()


class DoneResult(Result):
    """Base of the results of what was written or changed: fields, and a line that is told."""

    __slots__ = ()

    @property
    def said(self) -> str:
        """Summary in one line."""
        raise NotImplementedError

    def view(self) -> ResultView:
        """Return the fields for programs, and the line where it was not told."""
        names = [each.name for each in fields(cast(Any, self))]
        values = {name: getattr(self, name) for name in names}
        facts = (
            Fact(key=name, value=str(value) if isinstance(value, Path) else value)
            for name, value in values.items()
        )
        return ResultView([*facts, TextLine(text=self.said, is_reported=True)])


class ServedResult(Result):
    """Result of a verb that serves clients until it is stopped: it has no more to say."""

    __slots__ = ()

    def view(self) -> ResultView:
        """Return a view without items."""
        return ResultView()


def _columns(
    columns: Sequence[Column[Any]], rows: Sequence[Any]
) -> Iterator[tuple[str, list[Any]]]:
    """Yield names and values of columns; one of changes gives two."""
    for column in columns:
        values = [column.value(row) for row in rows] if column.key else []
        if any(isinstance(each, Change) for each in values):
            pairs = [
                (each.before, each.after) if isinstance(each, Change) else (None, each)
                for each in values
            ]
            yield f"{column.key}.before", [before for before, _ in pairs]
            yield f"{column.key}.after", [after for _, after in pairs]
        elif column.key:
            yield column.key, values
