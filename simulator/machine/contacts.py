"""Findings for collisions with the stock: rapids, holders and shanks in material. Units mm."""

from typing import Protocol

from simulator.removal.collision import Collision
from stepnc_model.errors import Finding, Severity

MOST = 20
"""Largest number of findings of one kind; further ones are only counted."""

LEAST_VOLUME = 1e-3
"""Volume that a rapid may remove without a finding, mm³: rounding of the map."""


class ContactRecorder(Protocol):
    """Stock that records its collisions."""

    collisions: list[Collision]
    """Rapid moves through material."""
    holder_collisions: list[Collision]
    shank_collisions: list[Collision]


def contacts(stock: ContactRecorder) -> list[Finding]:
    """Findings for rapid moves through material and for holder and shank collisions."""
    met = [hit for hit in stock.collisions if hit.volume > LEAST_VOLUME]
    told = [
        (hit, f"a rapid move cuts {hit.volume:.3g} mm³ of material near {_place(hit)}")
        for hit in met
    ]
    findings = _first(told, "rapid moves through material", Severity.ERROR)
    told = [
        (hit, f"the holder is {hit.depth:.3g} mm deep in the material at {_place(hit)}")
        for hit in stock.holder_collisions
    ]
    findings += _first(told, "moves with the holder in the material")
    told = [
        (
            hit,
            f"{hit.depth:.3g} mm of material above the cutting edge touches the shank at "
            f"{_place(hit)}",
        )
        for hit in stock.shank_collisions
    ]
    return findings + _first(told, "moves with material at the shank")


def _place(hit: Collision) -> str:
    x, y, z = hit.position
    return f"({x:.2f}, {y:.2f}, {z:.2f}) mm"


def _first(
    hits: list[tuple[Collision, str]], kind: str, severity: Severity = Severity.WARNING
) -> list[Finding]:
    findings = [
        Finding(severity=severity, message=text, line=hit.block) for hit, text in hits[:MOST]
    ]
    if len(hits) > MOST:
        more = f"{len(hits) - MOST} more {kind}"
        findings.append(Finding(severity=severity, message=more))
    return findings
