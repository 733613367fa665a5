"""Samples whose paths are planned."""

from pathlib import Path

PARTS = Path(__file__).parents[3] / "examples" / "parts"
BRACKET, SHAFT = PARTS / "bracket.stpnc", PARTS / "shaft.stpnc"
