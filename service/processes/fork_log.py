"""Log of a fork server and of what is forked from it; the first module that one loads."""

from service.processes import log_lines

# It says nothing but what goes wrong in it; a job chooses the level of its own log.
log_lines.configure("warning")
log_lines.report_faults()
