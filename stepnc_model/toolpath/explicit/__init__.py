"""Tool paths that the file gives, used as they are."""
