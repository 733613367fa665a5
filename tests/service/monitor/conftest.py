"""An agent that plays a run in real time."""

from collections.abc import Iterator

import pytest

from tests.extras.agent.model.conftest import serve
from tests.service.monitor.played import PlayedAgent, looped

__all__ = ["serve"]


@pytest.fixture
def played() -> Iterator[PlayedAgent]:
    with PlayedAgent(*looped()) as agent:
        yield agent
