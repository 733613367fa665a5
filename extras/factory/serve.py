"""A shop that runs at a pace, all of whose machines are devices of one MTConnect agent."""

import asyncio
from pathlib import Path

from extras.agent.model.agent import Agent
from extras.agent.model.http import application
from extras.agent.play import now
from extras.agent.run import listening, place_of, run_server
from extras.factory.cycles import PartCycles
from extras.factory.devices import shop_devices
from extras.factory.live import LiveShop
from extras.factory.plan import machining_plan
from extras.factory.requests import FactoryRequest, LiveFactoryRequest
from extras.factory.shop_observations import FASTEST, ShopPublisher, part_timelines
from extras.factory.shop_sources import chosen_shop, source_of_file
from service.progress import Tell, silent
from service.requests.fields import require_bounds
from service.web.known_hosts import for_known_hosts, known_hosts
from stepnc_model.errors import StepNcError
from stepnc_model.units import US_PER_SECOND, hours_from_seconds

STEP = 0.05
"""Wall-clock time between two looks at what is due, in s."""

AT_ONCE = 600.0
"""Longest simulated time between two answers to clients, in s."""

UPDATES = 10.0
"""Samples of a timeline per wall-clock second."""

MOST_DEVICES = 200


def serve_shop(file: Path, request: LiveFactoryRequest, *, tell: Tell = silent) -> None:
    """Serve a running shop until told to stop; after its end it shows the last values.

    Raises
    ------
    StepNcError
        When the file, a program or an option is invalid, or the port is not free.
    """
    require_bounds(request)
    require_live(request)
    shop = chosen_shop(source_of_file(file), request)
    if len(shop.machines) > MOST_DEVICES:
        raise StepNcError(
            f"{file.name}: {len(shop.machines)} machines: one agent serves at most "
            f"{MOST_DEVICES}"
        )
    with listening(request.host, request.port) as listener:
        plan = machining_plan(shop, PartCycles(tell=tell), place=file.name)
        rate = min(FASTEST, UPDATES / request.speed)
        timelines = part_timelines(shop, plan, rate=rate, tell=tell)
        devices = shop_devices(shop)
        publisher = ShopPublisher(shop, plan, devices, timelines)
        running = LiveShop(
            shop, plan, seed=request.seed, programs={}, listeners=publisher.listeners
        )
        publisher.watch(running.view)
        anchor = begin_of(shop.duration, request.speed)
        agent = Agent(
            model=devices.model,
            clock=now,
            size=request.buffer,
            begin=anchor,
            is_scaled=request.speed != 1.0,
        )
        work = ShopPlayer(running, publisher, agent, speed=request.speed, tell=tell)
        for machine, name in zip(shop.machines, devices.names, strict=True):
            renamed = "" if name == machine.name else f", device {name}"
            tell(f"machine {machine.name}{renamed}: http://{place_of(listener)}/{name}/current")
        tell(f"MTConnect agent: http://{place_of(listener)}/current")
        hosts = known_hosts(request.host, request.host_names)
        run_server(agent, for_known_hosts(application(agent), hosts), [work.run], listener)


def require_live(request: FactoryRequest) -> None:
    """Refuse options of which a live shop knows nothing.

    Raises
    ------
    StepNcError
    """
    if request.replications > 1 or request.sweep or request.documents or request.has_energy:
        raise StepNcError(
            "--live runs a shop once, for clients: leave out --replications, --sweep, "
            "--documents and --energy"
        )


def begin_of(duration: float, speed: float) -> int:
    """Stamp of the beginning of a run, µs since 1970: its end is not after the clock then."""
    ahead = duration - duration / speed if speed > 1.0 else 0.0
    return now() - int(ahead * US_PER_SECOND)


class ShopPlayer:
    """Advances a live shop by the clock, and hands its observations to an agent."""

    def __init__(
        self,
        shop: LiveShop,
        publisher: ShopPublisher,
        agent: Agent,
        *,
        speed: float,
        tell: Tell,
    ) -> None:
        self._shop, self._publisher, self._agent = shop, publisher, agent
        self._speed, self._tell = speed, tell
        self._anchor = agent.buffer.last_time

    async def run(self) -> None:
        """Run to the end of the simulated time, or of all orders."""
        begin, goes_on = now(), True
        shop = self._shop
        self._hand_on(0.0)
        while goes_on:
            due = self._speed * (now() - begin) / US_PER_SECOND
            until = min(due, shop.time + AT_ONCE)
            try:
                goes_on = shop.advance(until) if until > shop.time else True
            except StepNcError as error:
                self._tell(f"the shop stands still: {error}")
                return
            self._hand_on(shop.time)
            for event in shop.taken().events:
                self._tell(f"{hours_from_seconds(event.time):.2f} h: {event.text}")
            shop.changes()
            await asyncio.sleep(STEP if until == due else 0.0)

    def _hand_on(self, until: float) -> None:
        feed = self._publisher.taken(until)
        stamps = self._anchor + (feed.times * US_PER_SECOND).astype(int)
        self._agent.add(feed.items, stamps, feed.values)
