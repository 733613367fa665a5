"""Optimise the feeds of a program and write them back.

examples:
  optimise part.stpnc --mode TC --machine vmc15
  optimise part.stpnc --mode QC --roughness 1.6 --report part.html
  optimise part.stpnc --mode EC --free feed,depth,speed --dry-run --json
  optimise part.nc --tools tools.csv --stock 0,0,-20,100,60,0 --material c45

The program is STEP-NC (ISO 14649 or AP238), or NC code, or a folder of STEP-NC programs. It is
told by its content, and written back in the form that was read.

Exit codes: 0 ok, 3 bad input, 4 infeasible, 5 limit exceeded, 6 nothing to advise.
"""
