"""The verb ``record``: a machine's MTConnect data as a file."""
