"""Observers follow the motion of a run: they find the largest speed, the ground forces and the lost contact of each cell.

A lane is one cell in arrays, (lanes,), on its side, +1 right or -1 left, at the displacement y >= 0 with v = dy/dtau, tau = p t. An arc is
its motion over one step. (k, u) is a position in the motion, segment k and the phase u since its start; in formulas of forces u is |theta|
[rad]. A push is the ground acceleration over g, positive outward; the drive is the ground acceleration over its value at uplift.
"""
