"""Where an error says that a program is wrong."""

from stepnc_model.errors import SchemaError


def place_of(error: SchemaError) -> str:
    """Instance and attribute of an error, as in ``#206.axial_cutting_depth``."""
    instance = error.entity.partition(" ")[0]
    return f"{instance}.{error.attribute}" if error.attribute else instance
