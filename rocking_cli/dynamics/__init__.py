"""The response of a structure to a motion: an equation of motion on a contact with the
ground, marched from event to event.

`response` is the front door, `march.engine` the loop; `lemmas` states and proves what
the march relies on. A cell is one body under one motion of one A and Omega, a lane a
cell in arrays, (lanes,). On its side, +1 on the right edge (theta > 0) or -1, it has
the displacement y >= 0; time is tau = p t. The motion s(phase) consists of segments on
which s is monotone: (k, u) is segment k and the phase u since its start. The drive a is
the ground acceleration over its value at uplift, positive if it pushes the body
outward.
"""
