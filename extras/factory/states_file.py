"""States of all machines of a shop over time, as a Parquet file and for pictures."""

from pathlib import Path
from types import TracebackType

import numpy as np

from extras.factory.model.records import StateSpent
from extras.factory.model.shop import Shop
from extras.factory.model.states import MachineState
from service.outputs.run_file import ColumnKind, RunColumn, RunFile, Words

COLUMNS = (
    RunColumn(name="machine", kind=ColumnKind.WORDS),
    RunColumn(name="state", kind=ColumnKind.WORDS),
    RunColumn(name="begin_s", kind=ColumnKind.EXACT, unit="s"),
    RunColumn(name="end_s", kind=ColumnKind.EXACT, unit="s"),
    RunColumn(name="energy_j", kind=ColumnKind.EXACT, unit="J"),
)

WAITING = 20_000
"""States written together."""

MOST_SHOWN = 30_000
"""First states that are kept for a picture."""

WORD_OF = {state: number for number, state in enumerate(MachineState)}


class StateFile:
    """File of states; used with ``with``. Running state.

    Raises
    ------
    WriteError
        When the disk refuses.
    """

    def __init__(self, path: Path, shop: Shop) -> None:
        self._file = RunFile(path, COLUMNS)
        self._machines = [machine.name for machine in shop.machines]
        self._rows: list[StateSpent] = []

    def __enter__(self) -> "StateFile":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        with self._file.closing(is_whole=kind is None):
            self._write()

    def state(self, spent: StateSpent) -> None:
        """Write a state."""
        self._rows.append(spent)
        if len(self._rows) >= WAITING:
            self._write()

    def _write(self) -> None:
        if not self._rows:
            return
        machine, state, begin, end, energy = zip(*self._rows, strict=True)
        self._rows.clear()
        states = np.array([WORD_OF[each] for each in state], np.int32)
        self._file.write([
            Words(codes=np.array(machine, np.int32), names=self._machines),
            Words(codes=states, names=[each.value for each in MachineState]),
            np.array(begin),
            np.array(end),
            np.array(energy),
        ])


class ShownStates:
    """First states of a run, for a picture. Running state."""

    def __init__(self) -> None:
        self.rows: list[StateSpent] = []

    def state(self, spent: StateSpent) -> None:
        """Keep a state, while there is room."""
        if len(self.rows) < MOST_SHOWN:
            self.rows.append(spent)
