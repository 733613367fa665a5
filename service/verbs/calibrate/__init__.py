"""Fit a machine file to measured runs of a program, or tool life to measured lives.

Runs are tables with time_s and powers in W, columns named as `stepnc simulate` writes them;
--program, or --nc, names what was run. With --life or --tool-life, Taylor's law is fitted.
"""
