"""Requests of MTConnect clients: their parameters, checked.

References
----------
.. [1] ANSI/MTC1.4-2018, MTConnect Standard, Part 1, Overview and Fundamentals, 8.3: HTTP.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from simulator.agent.buffer import ObservationBuffer
from simulator.agent.documents import RequestFault
from simulator.agent.model import DeviceModel
from simulator.agent.selection import PathFault, selected

USUAL_COUNT = 100
USUAL_HEARTBEAT = 10_000
"""ms"""

LONGEST_WAIT = 2**31 - 1
"""ms, of an interval or a heartbeat"""

LEAST_HEARTBEAT = 2
"""ms"""


class RequestRefused(Exception):
    """A request with faults; each is listed in the answer."""

    def __init__(self, status: int, *faults: RequestFault) -> None:
        super().__init__(faults[0].message if faults else "")
        self.status = status
        self.faults = faults


@dataclass(frozen=True, slots=True, kw_only=True)
class StreamQuery:
    """Parameters of ``current`` and ``sample``."""

    chosen: frozenset[int] | None
    """data items; None: all"""
    at: int | None = None
    start: int | None = None
    """``from``"""
    end: int | None = None
    """``to``"""
    count: int = USUAL_COUNT
    interval: int | None = None
    """ms; None: one document"""
    heartbeat: int = USUAL_HEARTBEAT
    """ms"""


class _Parameters:
    """Query parameters as they are read; faults are gathered."""

    def __init__(self, values: Mapping[str, str]) -> None:
        self.faults: list[RequestFault] = []
        self._values = values

    def number(self, name: str, low: int, high: int, *, message: str = "") -> int | None:
        """A whole number within bounds; None where it is absent or at fault."""
        text = self._values.get(name)
        if text is None:
            return None
        try:
            value = int(text)
        except ValueError:
            self._add("INVALID_PARAMETER_VALUE", name, text, f"'{name}' is not an integer")
            return None
        if not low <= value <= high:
            bound = f"'{name}' must be at least {low}"
            if value > high:
                bound = f"'{name}' must be at most {high}"
            self._add("OUT_OF_RANGE", name, text, message or bound, low, high)
            return None
        return value

    def refuse(self, name: str, message: str, low: int, high: int) -> None:
        """Add a fault of a number that contradicts another."""
        self._add("OUT_OF_RANGE", name, self._values.get(name, ""), message, low, high)

    def finish(self) -> None:
        """Refuse the request if anything was at fault."""
        if self.faults:
            raise RequestRefused(400, *self.faults)

    def _add(
        self,
        code: str,
        name: str,
        value: str,
        message: str,
        low: int | None = None,
        high: int | None = None,
    ) -> None:
        fault = RequestFault(
            code=code,
            message=message,
            parameter=name,
            value=value[:200],
            type="integer",
            format="int64",
            minimum=low,
            maximum=high,
        )
        self.faults.append(fault)


def current_query(
    values: Mapping[str, str],
    model: DeviceModel,
    buffer: ObservationBuffer,
    *,
    device: int | None,
) -> StreamQuery:
    """Parameters of ``current``.

    Raises
    ------
    RequestRefused
    """
    read = _Parameters(values)
    at = read.number("at", buffer.first, buffer.last)
    interval = read.number("interval", 0, LONGEST_WAIT)
    if at is not None and interval is not None:
        read.refuse("interval", "'interval' and 'at' exclude each other", 0, LONGEST_WAIT)
    chosen = _chosen(values, model, device, read)
    read.finish()
    return StreamQuery(chosen=chosen, at=at, interval=interval)


def sample_query(
    values: Mapping[str, str],
    model: DeviceModel,
    buffer: ObservationBuffer,
    *,
    device: int | None,
) -> StreamQuery:
    """Parameters of ``sample``.

    Raises
    ------
    RequestRefused
    """
    read = _Parameters(values)
    count = read.number("count", -buffer.size, buffer.size)
    start = read.number("from", buffer.first, buffer.next)
    end = read.number("to", buffer.first, buffer.last)
    interval = read.number("interval", 0, LONGEST_WAIT)
    heartbeat = read.number("heartbeat", LEAST_HEARTBEAT, LONGEST_WAIT)
    if count == 0:
        read.refuse("count", "'count' must not be 0", -buffer.size, buffer.size)
    if end is not None and end < (start or buffer.first):
        read.refuse("to", "'to' must not lie before 'from'", start or buffer.first, buffer.last)
    if count is not None and count < 0:
        if end is not None:
            read.refuse("count", "'count' must be positive beside 'to'", 1, buffer.size)
        if interval is not None:
            read.refuse("count", "'count' must be positive in a stream", 1, buffer.size)
    chosen = _chosen(values, model, device, read)
    read.finish()
    return StreamQuery(
        chosen=chosen,
        start=start,
        end=end,
        count=USUAL_COUNT if count is None else count,
        interval=interval,
        heartbeat=USUAL_HEARTBEAT if heartbeat is None else heartbeat,
    )


def _chosen(
    values: Mapping[str, str], model: DeviceModel, device: int | None, read: _Parameters
) -> frozenset[int] | None:
    """Data items of a device, a kind of device and a path; None: all."""
    chosen = None if device is None else model.items_of(device)
    wanted = values.get("deviceType")
    if wanted is not None:
        if wanted not in {"Device", "Agent"}:
            fault = RequestFault(
                code="INVALID_PARAMETER_VALUE",
                message="'deviceType' must be 'Device' or 'Agent'",
                parameter="deviceType",
                value=wanted[:200],
                type="string",
            )
            read.faults.append(fault)
        kinds = [
            model.items_of(at)
            for at, each in enumerate(model.devices)
            if each.is_agent is (wanted == "Agent")
        ]
        of_kind = frozenset[int]().union(*kinds)
        chosen = of_kind if chosen is None else chosen & of_kind
    path = values.get("path")
    if path is None:
        return chosen
    try:
        found = selected(model, path)
    except PathFault as error:
        message = f"path '{path[:200]}': {error}"
        read.faults.append(RequestFault(code="INVALID_XPATH", message=message))
        return chosen
    both = found if chosen is None else found & chosen
    if not both:
        message = f"path '{path[:200]}' finds no data items of this device"
        read.faults.append(RequestFault(code="INVALID_XPATH", message=message))
    return both
