"""Tool tables in the formats of controls and CAM systems."""
