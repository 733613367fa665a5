"""Fit modes, for chatter stability, to a measured frequency response.

The file has the columns frequency_hz, and real and imaginary part: real_um_n and imag_um_n (or
m_n, mm_n; m_s2_n for an accelerometer). Modes of the same part in the same direction are
replaced in the machine.
"""
