"""Result of a verb: the base of what every verb returns."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from service.exit_codes import OK
from service.rendering.columns import Change, Column
from service.rendering.view import ResultView
from stepnc_model.errors import StepNcError

if TYPE_CHECKING:
    import plotly.graph_objects as go
    import pyarrow as pa

WIDE = 10_000
"""Characters per line of a text that no terminal limits."""


class Result:
    """Base of the results of verbs; each declares its view, and a page if it has one."""

    __slots__ = ()

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

    def save(self, path: str | Path) -> Path:
        """Write the result as a page (``.html``), JSON (``.json``), table (``.csv``) or text.

        Raises
        ------
        StepNcError
            When the name ends otherwise.
        """
        # Imported late, as what writes files is not needed where none is written.
        from service.files import write_atomically  # noqa: PLC0415
        from service.flat_file import Format, write_rows  # noqa: PLC0415
        from service.rendering.records import dump, file_columns, file_rows  # noqa: PLC0415

        place = Path(path)
        match place.suffix.lower():
            case ".html":
                write_atomically(place, self.page().encode())
            case ".json":
                write_atomically(place, dump(self.record()).encode())
            case ".csv" | ".parquet" as suffix:
                found = self.view().table()
                rows = file_rows(found.columns, found.rows)
                form = Format(suffix[1:])
                write_rows(place, file_columns(found.columns), rows, form=form)
            case ".txt":
                write_atomically(place, f"{self}\n".encode())
            case suffix:
                raise StepNcError(
                    f"{place}: '{suffix}' is none of .html, .json, .csv, .parquet and .txt"
                )
        return place

    def __str__(self) -> str:
        return "\n".join(text for text, _ in self.view().lines(width=WIDE, is_told=False))

    def _repr_html_(self) -> str:
        """Return what notebooks show."""
        return self.view().html()


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
