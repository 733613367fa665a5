"""Stock that a run leaves: whether a tool touched it, and the file that keeps it."""

from pathlib import Path

from service.files import write_atomically
from service.simulation.gathering import RunCollector
from service.simulation.setup import PreparedRun
from simulator.machine.virtual import VirtualMachine
from simulator.removal.engage import MillingStock
from simulator.removal.lathe import TurningStock
from simulator.removal.stock_file import stock_bytes
from stepnc_model.errors import Finding, Severity, StepNcError

TRACE = 0.1
"""Volume that counts as none, mm³: edges of a stock that was cut before are known to a cell."""


def keep_stock(virtual: VirtualMachine, path: Path) -> None:
    """Write the stock that was clamped last, as it is now.

    Raises
    ------
    StepNcError
        When no stock was clamped, or the file cannot be written.
    """
    kept = [each for each in virtual.stocks if isinstance(each, MillingStock | TurningStock)]
    if not kept:
        raise StepNcError(f"{path}: no stock was clamped that could be kept")
    write_atomically(path, stock_bytes(kept[-1]))


def untouched(
    prepared: PreparedRun, virtual: VirtualMachine, run: RunCollector
) -> tuple[Finding, ...]:
    """Finding that no feed move of the run met the stock; none if one did."""
    raw, reach = prepared.raw, virtual.reach
    if raw is None or prepared.tools is None or reach is None:
        return ()
    if sum(total.volume for total in run.totals) > TRACE:
        return ()
    low, high = reach[0].tolist(), reach[1].tolist()
    is_apart = any(
        one > end or begin > other
        for begin, end, one, other in zip(raw.low, raw.high, low, high, strict=True)
    )
    text = (
        f"no tool touched the stock, which spans {_box(raw.low, raw.high)}; the feed moves "
        f"span {_box(low, high)}: "
        f"{'is it in coordinates of the program?' if is_apart else 'is it cut already?'}"
    )
    return (Finding(severity=Severity.WARNING, message=text),)


def _box(low: tuple[float, ...] | list[float], high: tuple[float, ...] | list[float]) -> str:
    """Span on each axis, for a message."""
    spans = zip("xyz", low, high, strict=True)
    return ", ".join(f"{axis} {one:g} to {other:g}" for axis, one, other in spans) + " mm"
