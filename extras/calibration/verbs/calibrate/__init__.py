"""Fit a machine file to measured runs, or a material's forces, roughness and tool life to cuts.

Runs are tables with time_s and powers in W, columns named as `stepnc simulate` writes them;
--program, or --nc, names what was run. --table fits the material to measured cuts, one a row;
a second call with the written file and more rows fits all of them.
With --life or --tool-life, Taylor's law is fitted to speeds and lives alone.
"""
