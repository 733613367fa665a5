"""What met the stock and should not have, told to the user."""

from typing import Protocol

from simulator.removal.collision import Collision
from stepnc_model.errors import Finding, Severity

MOST = 20
"""findings of one kind; the rest is counted"""

LEAST_VOLUME = 1e-3
"""mm³ by which a rapid may graze what is just cut: rounding of the map"""


class Met(Protocol):
    """A stock that knows what met it."""

    collisions: list[Collision]
    """rapids through material"""
    holder_collisions: list[Collision]
    shank_collisions: list[Collision]


def contacts(stock: Met) -> list[Finding]:
    """Findings for rapids through material, holders and shanks that met it."""
    met = [hit for hit in stock.collisions if hit.volume > LEAST_VOLUME]
    told = [
        (hit, f"a rapid cuts {hit.volume:.3g} mm³ of material, up to {_place(hit)}")
        for hit in met
    ]
    findings = _first(told, "rapids through material")
    told = [
        (hit, f"the holder is {hit.depth:.3g} mm deep in the material at {_place(hit)}")
        for hit in stock.holder_collisions
    ]
    findings += _first(told, "moves with the holder in the material")
    told = [
        (
            hit,
            f"{hit.depth:.3g} mm of material above the cutting edge meet the shank at "
            f"{_place(hit)}",
        )
        for hit in stock.shank_collisions
    ]
    return findings + _first(told, "moves with material at the shank")


def _place(hit: Collision) -> str:
    x, y, z = hit.position
    return f"({x:.2f}, {y:.2f}, {z:.2f}) mm"


def _first(told: list[tuple[Collision, str]], kind: str) -> list[Finding]:
    findings = [
        Finding(severity=Severity.WARNING, message=text, line=hit.block)
        for hit, text in told[:MOST]
    ]
    if len(told) > MOST:
        more = f"{len(told) - MOST} more {kind}"
        findings.append(Finding(severity=Severity.WARNING, message=more))
    return findings
