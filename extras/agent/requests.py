"""Request of an agent."""

from dataclasses import dataclass
from typing import Annotated

from annotated_types import Interval, MaxLen

from service.requests.fields import About
from service.requests.program_facts import Name
from service.requests.runs import SimulationRequest
from simulator.client.document_choices import NameSet, SchemaVersion

AGENT = "options of the agent"
"""Heading in the help."""


@dataclass(frozen=True, slots=True, kw_only=True)
class AgentRequest(SimulationRequest):
    """Request of an agent that publishes a run of the virtual machine."""

    schema: Annotated[
        SchemaVersion,
        About("schema version of the documents: 1.3, 2.0 or 2.7", group=AGENT, flag="--schema"),
    ] = SchemaVersion.V2_7
    names: Annotated[
        NameSet,
        About(
            "ids of the data items: modern, or those of the papers", group=AGENT, flag="--names"
        ),
    ] = NameSet.MODERN
    part: Annotated[Name, About("id of the part", group=AGENT, flag="--part", metavar="ID")] = (
        ""
    )
    batch: Annotated[
        Name,
        About(
            "id of the batch; its parts are ID-0, ID-1, …",
            group=AGENT,
            flag="--batch",
            metavar="ID",
        ),
    ] = ""
    speed: Annotated[
        float,
        Interval(ge=0.0, le=100_000.0),
        About("simulated seconds per wall-clock second; 0: the whole run at once",
              name="speed", group=AGENT, flag="--speed", metavar="X"),
    ] = 1.0  # fmt: skip
    is_looped: Annotated[
        bool, About("start the program again when it is over", group=AGENT, flag="--loop")
    ] = False
    buffer: Annotated[
        int,
        Interval(ge=1000, le=1 << 22),
        About("observations that are kept", group=AGENT, flag="--buffer", metavar="N"),
    ] = 1 << 17  # fmt: skip
    port: Annotated[
        int,
        Interval(ge=0, le=65535),
        About("port to listen on; 0: any that is free", group=AGENT, flag="--port",
              metavar="N"),
    ] = 5000  # fmt: skip
    host: Annotated[str, About("address to listen on", group=AGENT, flag="--host")] = (
        "127.0.0.1"
    )
    host_names: Annotated[
        tuple[Name, ...],
        MaxLen(100),
        About(
            "a host name by which clients reach this computer, beside its addresses; "
            "repeatable",
            group=AGENT, flag="--name", metavar="HOST",
        ),
    ] = ()  # fmt: skip
    shdr_port: Annotated[
        int | None,
        Interval(ge=0, le=65535),
        About("port of an SHDR adapter that feeds other agents", name="SHDR port",
              group=AGENT, flag="--shdr", metavar="N"),
    ] = None  # fmt: skip
    allows_put: Annotated[
        bool,
        About("let clients write assets and observations", group=AGENT, flag="--allow-put"),
    ] = False
    mqtt: Annotated[
        str | None,
        MaxLen(300),
        About("MQTT broker to publish to (extra: mqtt)", name="MQTT broker", group=AGENT,
              flag="--mqtt", metavar="HOST:PORT"),
    ] = None  # fmt: skip
    adapters: Annotated[
        tuple[Annotated[str, MaxLen(300)], ...],
        MaxLen(20),
        About("SHDR adapter to listen to, with --device; repeatable", group=AGENT,
              flag="--adapter", metavar="HOST:PORT"),
    ] = ()  # fmt: skip
