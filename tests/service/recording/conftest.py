"""Agents to be read."""

from tests.simulator.agent.conftest import serve

__all__ = ["serve"]
