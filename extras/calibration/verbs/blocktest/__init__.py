"""Write a test program for the block rate of a control.

Run the program on the machine, record it with `stepnc record`, and give both to
`stepnc blockfit`.
"""
