"""An agent within one event loop."""

import asyncio

import numpy as np
import pytest

from extras.agent.model.agent import Agent
from tests.extras.agent.model.conftest import BEGIN, mill


@pytest.mark.parametrize("turns", range(5))
def test_a_wait_can_be_cancelled_while_an_observation_comes(turns: int) -> None:
    """A stream whose client has left would go on for ever."""

    async def is_kept() -> bool:
        agent = Agent(model=mill("2.7"), clock=lambda: BEGIN, size=1 << 10)
        waiting = asyncio.create_task(agent.wait(agent.buffer.next, 60.0))
        for _ in range(3):
            await asyncio.sleep(0.0)
        agent.add(np.zeros(1, dtype=int), np.full(1, BEGIN), ["AVAILABLE"])
        for _ in range(turns):
            await asyncio.sleep(0.0)
        is_taken = waiting.cancel()
        await asyncio.wait([waiting])
        return waiting.cancelled() or not is_taken

    assert asyncio.run(is_kept())
