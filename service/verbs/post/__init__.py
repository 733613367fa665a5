"""Write NC code for a control.

Examples
--------
  stepnc post part.stpnc --control linuxcnc
  stepnc post part.stpnc --control fanuc --cycles -o part.nc
"""
