"""The equations of motion, y'' = -w l(y) + a m(y) - 2 zeta y', and the flows that solve them between two events.

y >= 0 is the displacement of a body on its side, a the drive (ground acceleration over its value at uplift, positive outward), w the weight
over m g. Time is tau = p t, and h [tau] counts from the start of a step. A lane is one cell in arrays, (lanes,), at the phase u since the
start of segment k of the motion. Series of l and m are called F/F0 and G/G0.
"""
