"""The contact of a body with the ground: where it lifts off, what an impact does, how bounces and the free motion end.

A lane is one cell in arrays, (lanes,): a body on its side, +1 on the right edge (theta > 0) and -1 on the left, at the displacement y >= 0,
with v = dy/dtau and the force b = y'' + 2 zeta y'; tau = p t. A position (k, u) in the motion is its segment k and the phase u since the
start of k. The drive a is the ground acceleration over its value at uplift, positive outward.
"""
