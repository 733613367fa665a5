"""Convert a program to AP238 or ISO 14649, or its records to the other profile.

Examples
--------
  stepnc convert part.stpnc --to ap238 -o part.238
  stepnc convert part.238 --to iso14649 -o part.stpnc
  stepnc convert part.stpnc --profile standard -o standard.stpnc
"""
