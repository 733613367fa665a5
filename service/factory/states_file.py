"""States of all machines of a shop over time, as a Parquet file and for pictures."""

from pathlib import Path
from types import TracebackType

import pyarrow as pa

from service.run_file import WORDS, RunFile
from simulator.factory.records import StateSpent
from simulator.factory.shop import Shop
from simulator.factory.states import MachineState

SCHEMA = pa.schema([
    pa.field("machine", WORDS),
    pa.field("state", WORDS),
    pa.field("begin_s", pa.float64(), metadata={"unit": "s"}),
    pa.field("end_s", pa.float64(), metadata={"unit": "s"}),
    pa.field("energy_j", pa.float64(), metadata={"unit": "J"}),
])

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
        self._file = RunFile(path, SCHEMA)
        self._machines = pa.array([machine.name for machine in shop.machines])
        self._states = pa.array([state.value for state in MachineState])
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
        words = pa.array([WORD_OF[each] for each in state], pa.int32())
        self._file.write([
            pa.DictionaryArray.from_arrays(pa.array(machine, pa.int32()), self._machines),
            pa.DictionaryArray.from_arrays(words, self._states),
            pa.array(begin),
            pa.array(end),
            pa.array(energy),
        ])


class ShownStates:
    """First states of a run, for a picture. Running state."""

    def __init__(self) -> None:
        self.rows: list[StateSpent] = []

    def state(self, spent: StateSpent) -> None:
        """Keep a state, while there is room."""
        if len(self.rows) < MOST_SHOWN:
            self.rows.append(spent)
