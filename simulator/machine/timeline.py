"""Columns of a run as written to files: names and units of the data items.

Names follow the data items of Shin et al., "Developing a virtual machining model to generate
MTConnect machine-monitoring data from STEP-NC", Int. J. Prod. Res. 54 (2016), Table 2, with the
total as in Lechevalier et al. (2018), Table 2. Units are those of MTConnect: MILLIMETER,
MILLIMETER/SECOND, REVOLUTION/MINUTE, WATT, NEWTON.
"""

from dataclasses import dataclass

from stepnc_model.units import rpm_from_rev_s

RPM = rpm_from_rev_s(1.0)
"""Revolutions per minute in one revolution per second."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DataItem:
    """Data item: one column of a run, with its name, source and unit."""

    name: str
    source: str
    """Attribute of the samples from which the values are taken."""
    unit: str = ""
    scale: float = 1.0
    """External units per internal unit."""
    axis: int | None = None
    """Column index if the attribute is an array with three columns."""
    words: tuple[str, ...] | None = None
    """Words for the integer values of an event, from 0 on."""


def _axes(
    suffix: str, source: str, unit: str = "", words: tuple[str, ...] | None = None
) -> tuple[DataItem, ...]:
    return tuple(
        DataItem(name=f"{name}_axis_{suffix}", source=source, unit=unit, axis=row, words=words)
        for row, name in enumerate("xyz")
    )


COLUMNS = (
    DataItem(name="time_s", source="time", unit="s"),
    *_axes("position_actual", "position", "mm"),
    *_axes("velocity_actual", "velocity", "mm/s"),
    *_axes("wattage", "axis_power", "W"),
    DataItem(name="c_axis_wattage", source="spindle_power", unit="W"),
    DataItem(name="coolant_wattage", source="coolant_power", unit="W"),
    DataItem(name="load_wattage", source="base_power", unit="W"),
    DataItem(name="electric_wattage", source="total_power", unit="W"),
    DataItem(name="path_feedrate_programmed", source="feed_programmed", unit="mm/s"),
    DataItem(name="path_feedrate_actual", source="path_speed", unit="mm/s"),
    DataItem(
        name="rotary_velocity_programmed", source="spindle_programmed", unit="rpm", scale=RPM
    ),
    DataItem(name="rotary_velocity_actual", source="spindle_speed", unit="rpm", scale=RPM),
    DataItem(name="cutting_wattage", source="cutting_power", unit="W"),
    DataItem(name="cutting_force", source="cutting_force", unit="N"),
    DataItem(name="feed_force", source="feed_force", unit="N"),
    DataItem(name="back_force", source="back_force", unit="N"),
    DataItem(name="removal_rate", source="removal_rate", unit="mm³/s"),
    DataItem(name="chip_thickness", source="chip_thickness", unit="mm"),
    DataItem(name="thrust", source="thrust", unit="N"),
    DataItem(name="tool_deflection", source="deflection", unit="mm"),
    DataItem(name="axial_depth", source="axial_depth", unit="mm"),
    DataItem(name="radial_width", source="radial_width", unit="mm"),
    DataItem(
        name="execution",
        source="execution",
        words=("READY", "ACTIVE", "WAIT", "PROGRAM_STOPPED", "PROGRAM_COMPLETED"),
    ),
    DataItem(name="path_mode", source="path_mode", words=("NONE", "RAPID", "FEED")),
    *_axes("direction", "direction", words=("NEGATIVE", "NONE", "POSITIVE")),
    DataItem(
        name="rotary_direction",
        source="rotation",
        words=("COUNTER_CLOCKWISE", "NONE", "CLOCKWISE"),
    ),
    DataItem(name="coolant", source="coolant", words=("OFF", "ON")),
    DataItem(name="overload", source="overload", words=("NORMAL", "WARNING", "FAULT")),
    DataItem(name="program", source="program"),
    DataItem(name="line", source="line"),
    DataItem(name="tool_number", source="tool"),
    DataItem(name="workingstep", source="workingstep"),
)
"""All columns in the order of the file; words for program and workingstep come from the run."""
