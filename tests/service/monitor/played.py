"""An agent of our own that a test ends and starts again at the same address."""

import asyncio
import threading
from functools import cache

import httpx
import uvicorn

from extras.agent.model.http import application
from extras.agent.play import begun, play
from extras.agent.requests import AgentRequest
from extras.agent.run import PublishedRun, listening
from tests.extras.agent.test_run import run_of


class PlayedAgent:
    """Agent that plays a run. Running state; use it with ``with``."""

    def __init__(self, request: AgentRequest, run: PublishedRun) -> None:
        self._request, self._run = request, run
        self.port = 0
        self._server: uvicorn.Server | None = None
        self._thread: threading.Thread | None = None

    @property
    def url(self) -> str:
        """Address of its device."""
        return f"http://127.0.0.1:{self.port}/{self._run.machine.name}"

    def __enter__(self) -> "PlayedAgent":
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def start(self) -> None:
        """Listen on a free port, or on the one that it had before."""
        listener = listening("127.0.0.1", self.port)
        self.port = listener.getsockname()[1]
        agent = begun(self._run, speed=self._request.speed, size=self._request.buffer)
        config = uvicorn.Config(
            application(agent), log_config=None, lifespan="off", ws="none",
            timeout_graceful_shutdown=1,
        )  # fmt: skip
        server = self._server = uvicorn.Server(config)
        speed, is_looped = self._request.speed, self._request.is_looped

        async def work() -> None:
            player = asyncio.create_task(
                play(agent, self._run, speed=speed, is_looped=is_looped)
            )
            await server.serve(sockets=[listener])
            player.cancel()

        self._thread = threading.Thread(target=asyncio.run, args=(work(),))
        self._thread.start()
        httpx.get(f"{self.url}/probe", timeout=120.0, trust_env=False)

    def stop(self) -> None:
        """End it, and its connections."""
        if self._server is not None and self._thread is not None:
            self._server.should_exit = True
            self._server.force_exit = True
            self._thread.join(120.0)
        self._server = None


@cache
def looped() -> tuple[AgentRequest, PublishedRun]:
    """The first case of paper 003, played in real time again and again."""
    return run_of("paper003_case1", "paper003", rate_hz=20.0, speed=1.0, is_looped=True)
