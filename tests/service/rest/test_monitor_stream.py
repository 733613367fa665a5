"""Events of a monitor: everybody gets the same rows, and the status every second."""

import asyncio
import json
from functools import partial
from pathlib import Path
from typing import Any

from service.monitor.monitor import MachineMonitor
from service.monitor.source import MonitorSource
from service.rest.monitor_stream import MonitorReader
from service.rest.streams import StreamClient, StreamHub
from service.storage.folder import open_data_folder
from tests.service.monitor.played import PlayedAgent, looped
from tests.service.waiting import until


def contents(messages: list[bytes], name: str) -> list[Any]:
    head = f"event: {name}\ndata: ".encode()
    return [json.loads(each[len(head) :]) for each in messages if each.startswith(head)]


def test_rows_are_told_to_all_and_the_status_when_it_changes(tmp_path: Path) -> None:
    with PlayedAgent(*looped()) as played:
        monitor = MachineMonitor(MonitorSource(name="paper003", url=played.url))
        monitor.start()
        try:
            until(lambda: monitor.count > 5)
            first, second = asyncio.run(_heard(monitor, tmp_path))
        finally:
            monitor.stop()
    times = [time for each in contents(first, "rows") for time in each["columns"]["time_s"]]
    assert times == sorted(set(times))
    assert len(times) > 10
    assert contents(first, "rows") == contents(second, "rows")
    statuses = contents(first, "status")
    # One at the beginning, one by the first poll, and one each second.
    assert 2 <= len(statuses) < 12
    assert statuses[0]["name"] == "paper003"


async def _heard(monitor: MachineMonitor, folder: Path) -> list[list[bytes]]:
    """Messages of two subscribers that came together."""
    hub = StreamHub(open_data_folder(folder, knowledge="none.db"))
    found: list[list[bytes]] = [[], []]

    async def listen(messages: list[bytes]) -> None:
        async for message in hub.watch_by("paper003", partial(MonitorReader, monitor)):
            messages.append(message)
            if len(contents(messages, "rows")) >= 10:
                return

    async with asyncio.timeout(20.0):
        await asyncio.gather(*map(listen, found))
    await hub.close()
    rows = [contents(each, "rows")[:10] for each in found]
    assert rows[0]
    return found


def test_a_reader_ends_with_its_last_subscriber() -> None:
    monitor = MachineMonitor(MonitorSource(name="paper003", url="http://127.0.0.1:9"))
    reader = MonitorReader(monitor)

    async def work() -> None:
        client = StreamClient()
        reader.clients.add(client)
        running = asyncio.create_task(reader.run())
        async with asyncio.timeout(10.0):
            message = await client.queue.get()
        [told] = contents([message], "status")
        assert (told["state"], told["age_s"], told["latest"]) == ("never", None, {})
        reader.clients.clear()
        async with asyncio.timeout(10.0):
            await running

    asyncio.run(work())
    assert reader.is_finished
