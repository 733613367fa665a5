"""Programs that the tests send."""

from pathlib import Path

PARTS = Path(__file__).parents[3] / "examples" / "parts"

SAMPLE = PARTS / "paper002.stpnc"
"""a few seconds of machining"""
