"""Agents to be read."""

from tests.extras.agent.model.conftest import serve

__all__ = ["serve"]
