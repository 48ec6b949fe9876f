"""The equations of motion, y'' = -w l(y) + a m(y) - 2 zeta y', and the flows that solve
them between two events. w is the weight over m g, h [tau] counts from the start of a
step, and series of l and m are called F/F0 and G/G0.
"""
