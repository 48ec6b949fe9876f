"""Steppers take cells through a record: over many samples at once if it is proved that no impact occurs, else by rounds of the march.

A lane is one cell in arrays, (lanes,), at the displacement y >= 0 on its side, with v = dy/dtau, tau = p t. Segment k of a record begins at
sample k, and u is the phase since then. pace: tau between two samples. The drive a is the ground acceleration over its value at uplift,
positive outward.

stepper        the pool of lanes, which both steppers share
exact          the stepper of the undamped linear oscillator: exact propagation
taylor_steps   the stepper of every other equation: Taylor steps from sample to sample
"""
