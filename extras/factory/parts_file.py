"""Tables of the parts of each machine, with the columns of Fig. 11 of paper 003.

Times are in ms, the feed FR in m/s, the spindle speed SS in rev/s (negative clockwise), the
depth CD in mm. ``batchsetuptime`` stands in the first part of a batch only and
``batchejectiontime`` in the last. Rows are written as parts are made.

References
----------
Lechevalier, Shin, Rachuri, Foufou, Lee, Bouras (2018), Fig. 11.
"""

from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType

from extras.factory.model.records import PartMade
from extras.factory.model.shop import Shop
from service.outputs.formula import disarmed
from service.outputs.run_file import GrowingFile
from stepnc_model.units import m_s_from_speed, ms_from_seconds

COLUMNS = (
    "id", "material", "FR", "SS", "CD", "batchsetuptime", "partsetuptime", "machiningtime",
    "partejectiontime", "batchejectiontime",
)  # fmt: skip

ENERGY_COLUMNS = ("machiningpower_w", "machiningenergy_j", "good")

WAITING = 2_000
"""Rows written together."""


class PartTables:
    """One table for each machine; used with ``with``. Running state.

    Raises
    ------
    WriteError
        When the disk refuses.
    """

    def __init__(
        self, folder: Path, shop: Shop, materials: Mapping[int, str], *, has_energy: bool
    ) -> None:
        self._shop = shop
        self._materials = {row: disarmed(name) for row, name in materials.items()}
        self._has_energy = has_energy
        self._files = [GrowingFile(folder / f"{machine.name}.csv") for machine in shop.machines]
        header = (*COLUMNS, *ENERGY_COLUMNS) if has_energy else COLUMNS
        self._rows = [[",".join(header)] for _ in shop.machines]
        self.count = 0
        """Parts written."""

    def __enter__(self) -> "PartTables":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        with ExitStack() as stack:
            for file in self._files:
                stack.enter_context(file.closing(is_whole=kind is None))
            for machine in range(len(self._files)):
                self._write(machine)

    def part(self, part: PartMade) -> None:
        """Write a part."""
        settings = part.settings
        cells = [
            f"{part.batch}-{part.part}",
            self._materials[part.product],
            "" if settings.feed is None else _cell(m_s_from_speed(settings.feed)),
            _cell(settings.spindle_speed),
            _cell(settings.depth),
            _cell(ms_from_seconds(part.batch_setup)),
            _cell(ms_from_seconds(part.part_setup)),
            _cell(ms_from_seconds(part.machining)),
            _cell(ms_from_seconds(part.part_ejection)),
            _cell(ms_from_seconds(part.batch_ejection)),
        ]
        if self._has_energy:
            power = part.energy / part.machining if part.machining else 0.0
            cells += [_cell(power), _cell(part.energy), str(int(part.is_good))]
        rows = self._rows[part.machine]
        rows.append(",".join(cells))
        self.count += 1
        if len(rows) >= WAITING:
            self._write(part.machine)

    def _write(self, machine: int) -> None:
        rows, file = self._rows[machine], self._files[machine]
        if not rows:
            return
        data = "\n".join(rows) + "\n"
        rows.clear()
        try:
            file.stream.write(data.encode())
        except OSError as error:
            raise file.refused(error) from error


def _cell(value: float | None) -> str:
    """Number with as many digits as the paper prints; empty if there is none."""
    return "" if value is None else f"{value:.10g}"
