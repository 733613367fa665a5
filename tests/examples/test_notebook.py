"""The notebook runs from its first cell to its last, in a kernel of its own."""

import re
from pathlib import Path

import nbformat
from nbclient import NotebookClient

EXAMPLES = Path(__file__).parents[2] / "examples"
ALIKE = 0.05
"""greatest distance of planned and run time of a workingstep, relative"""


def test_notebook_runs_and_shows_tables_and_figures() -> None:
    notebook = nbformat.read(EXAMPLES / "11_notebook.ipynb", as_version=4)  # type: ignore[no-untyped-call]
    assert not any(cell.get("outputs") for cell in notebook.cells)  # kept without
    NotebookClient(
        notebook, timeout=600, kernel_name="python3", resources={"metadata": {"path": EXAMPLES}}
    ).execute()
    shown = [
        output.get("data", {}) for cell in notebook.cells for output in cell.get("outputs", ())
    ]
    assert sum("application/vnd.plotly.v1+json" in data for data in shown) == 3
    tables = [data["text/html"] for data in shown if "text/html" in data]
    assert len(tables) == 3
    assert "ROUGH FACE" in tables[0]
    ratios = [float(last) for last in re.findall(r"<td>([\d.]+)</td>\s*</tr>", tables[2])]
    assert len(ratios) == 16
    assert all(abs(ratio - 1.0) < ALIKE for ratio in ratios)
