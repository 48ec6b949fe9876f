"""The march takes cells from event to event. A cell is one body under one motion of one A and Omega, a lane a cell in arrays, (lanes,).

A lane is on a side, +1 right or -1 left, at the displacement y >= 0 with v = dy/dtau, tau = p t; its position in the motion is (k, u), the
segment k and the phase u since the start of k. The drive a is the ground acceleration over its value at uplift, positive outward. In a
window it stays below 1, or at 1 and above. A closing is a proof that ends the march of a lane.
"""
