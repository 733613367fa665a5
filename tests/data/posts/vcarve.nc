( Tools used in this file: )
(1 = End Mill {1/4 inch})
(2 = V-Bit {90 deg 1/2"})
G20 G17 G90 G40 G80
T1 M6
(Tool: End Mill {1/4 inch})
G43 H1
S16000 M3
G0 Z0.8
G0 X0.5 Y0.5
G1 Z-0.125 F30.
G1 X5.5 F100.
Y3.5
X0.5
Y0.5
G0 Z0.8
M30
