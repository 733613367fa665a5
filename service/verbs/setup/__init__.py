"""Draft the setup of NC code: tools, stock, zero, material and machine, to edit and give back.

Each value says where it comes from and how sure it is: given by you, stated by the program,
guessed, or missing. `optimise`, `simulate`, `control` and `cycletime` find the file beside the
program. A guess that you confirm lets feeds rise further.

    stepnc setup part.nc --material c45 --machine vmc15
    stepnc optimise part.nc
"""
