"""Programs that the tests send."""

from pathlib import Path

PARTS = Path(__file__).parents[3] / "examples" / "parts"

SAMPLE = PARTS / "paper002.stpnc"
"""a few seconds of machining"""

SLOT = PARTS / "paper003_case1.stpnc"
"""a slot, which has walls"""
