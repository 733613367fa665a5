"""What all processes of jobs have in common, loaded once in the process they are forked from."""

import service.simulation.report  # noqa: F401 (loaded for the children)
