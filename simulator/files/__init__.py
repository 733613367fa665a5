"""Files of the library: machines, materials, tool grades and work-holding."""
