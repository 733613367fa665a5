"""Logs of a small part, with errors put in."""

from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import pyarrow as pa
from pyarrow import compute, parquet

from service.requests.runs import SimulationRequest
from service.simulation.run import RunFiles, simulate
from tests.service.rest.samples import SLOT

SLOT_MACHINE = "paper003"

AXES = tuple(f"{axis}_axis_position_actual" for axis in "xyz")

COLUMNS = ("time_s", *AXES, "tool_number", "workingstep")


@cache
def slot_run() -> pa.Table:
    """Samples of the slot at 5 Hz."""
    with TemporaryDirectory() as folder:
        output = Path(folder) / "run.parquet"
        request = SimulationRequest(machine=SLOT_MACHINE, rate_hz=5.0)
        simulate(request, RunFiles(file=SLOT, output=output))
        return parquet.read_table(output).select(list(COLUMNS))


def slot_log(path: Path, *, lower: float = 0.0, change: str = "") -> Path:
    """Write a log of the slot.

    Parameters
    ----------
    path : Path
        Ends with ``.parquet``.
    lower : float
        Amount by which the tool is too low, mm.
    change : str
        What is wrong with the log: ``inches``, ``elsewhere`` or ``times``.
    """
    table = slot_run()
    for name, shift, factor in (
        (AXES[0], 500.0 if change == "elsewhere" else 0.0, 1.0),
        (AXES[2], -lower, 1.0),
        *((name, 0.0, 1.0 / 25.4) for name in AXES if change == "inches"),
        *(("time_s", 0.0, -1.0) for _ in range(change == "times")),
    ):
        column = compute.add(compute.multiply(table.column(name), factor), shift)
        table = table.set_column(table.column_names.index(name), name, column)
    parquet.write_table(table, path)
    return path
