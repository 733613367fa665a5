"""Show the tool paths of a program: generated, contained in it, or the moves of NC code.

Examples
--------
  stepnc toolpath part.stpnc --plot path.png
  stepnc toolpath part.ngc
"""
