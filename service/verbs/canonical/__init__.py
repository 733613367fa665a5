"""Show a program as canonical commands, to compare programs.

NC code for any control and STEP-NC programs become the same commands: one move, tool change or
switch a line. NC code is read strictly: a word that is not understood ends the command.

Examples
--------
  stepnc canonical part.ngc
  stepnc canonical part.nc --control fanuc --lathe
  stepnc canonical part.stpnc
"""
