"""Response bodies of verifications."""

from typing import Any

import numpy as np
from pydantic import ConfigDict, Field

from extras.verification.facts import SurfaceMap
from service.rest.views import FindingView, View


class SurfaceView(View):
    """Greatest gouge and excess on the walls or floors of a workingstep."""

    model_config = ConfigDict(extra="allow", frozen=True)

    workingstep: str
    feature: str
    tool: int | None = Field(description="number of the tool; null: unknown")
    surface: str = Field(description="wall, floor, face or diameter")
    gouge_mm: float
    gouge_uncertainty_mm: float
    gouge_least_mm: float | None = Field(
        default=None, description="least size; not positive where it may be none"
    )
    gouge_at_mm: list[float] = Field(description="x, y and z of the place")
    gouge_block: int = Field(description="block of the program; 0: none")
    gouge_time_s: float | None = Field(description="time in the log; null: none came near")
    gouge_cut_by: str = Field(description="workingstep that the log shows then")
    excess_mm: float
    excess_uncertainty_mm: float
    excess_least_mm: float | None = None
    excess_at_mm: list[float]
    excess_block: int
    excess_time_s: float | None
    excess_cut_by: str
    nominal_mm: list[float] | None = Field(
        description="least and greatest deviation from the nominal feature; null: unknown"
    )
    predicted_deflection_mm: float | None = Field(
        description="of the tool, which the log does not see; null: not requested or unknown"
    )
    area_mm2: float
    beyond: float = Field(description="share of the area beyond its uncertainty, 0 to 1")


class VolumesView(View):
    """Volumes that the programmed and the logged path remove."""

    programmed_mm3: float
    logged_mm3: float
    gouge_mm3: float
    excess_mm3: float


class BandView(View):
    """Share of the surface within a tolerance band."""

    width_mm: float = Field(description="half width of the band")
    share: float = Field(description="0 to 1")


class ResolutionView(View):
    """Resolution of a log normal to a surface."""

    step_mm: float = Field(description="way of the tool between samples")
    straight_mm: float
    arc_mm: float
    arc_radius_mm: float | None = Field(description="of the smallest arc; null: no arc")
    square_corner_mm: float


class VerificationView(View):
    """Result of a verification, as ``stepnc verify --json`` prints it."""

    model_config = ConfigDict(extra="allow", frozen=True)

    program: str
    machine: str
    log: str
    zero_mm: list[float]
    tolerance_mm: float
    has_errors: bool = Field(
        description="whether a deviation exceeds both its uncertainty and the tolerance"
    )
    verdict: str
    surfaces: list[SurfaceView]
    volumes: VolumesView
    bands: list[BandView]
    samples: dict[str, Any]
    resolution: ResolutionView
    cell_mm: float
    not_seen: list[str] = Field(description="what position feedback cannot see")
    findings: list[FindingView]


class SurfaceMapView(View):
    """Places on the surface with their deviations: the worst, and others evenly spread."""

    is_turned: bool = Field(description="whether x is the radius, and y 0")
    places: int = Field(description="number of places shown")
    left_out: int = Field(description="number of places left out")
    left_out_beyond_mm: float = Field(
        description="most by which one of those exceeds its uncertainty; 0: none does"
    )
    workingsteps: list[str]
    kinds: list[str]
    x_mm: list[float]
    y_mm: list[float]
    z_mm: list[float]
    deviation_mm: list[float] = Field(description="excess positive, gouge negative")
    uncertainty_mm: list[float]
    least_mm: list[float] = Field(description="least size; not positive where it may be none")
    workingstep: list[int] = Field(description="place in workingsteps, from 0")
    kind: list[int] = Field(description="place in kinds, from 0")
    block: list[int] = Field(description="block of the program; 0: none")
    time_s: list[float | None] = Field(description="time in the log; null: none came near")


def map_view(surface_map: SurfaceMap) -> dict[str, Any]:
    """Return a map as a :class:`SurfaceMapView`."""
    return {
        "is_turned": surface_map.is_turned,
        "places": len(surface_map.columns["block"]),
        "left_out": surface_map.left_out,
        "left_out_beyond_mm": round(surface_map.left_out_beyond, 4),
        "workingsteps": surface_map.workingsteps,
        "kinds": surface_map.kinds,
        **{name: np.ascontiguousarray(values) for name, values in surface_map.columns.items()},
    }
