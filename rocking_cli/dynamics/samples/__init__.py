"""Steppers take cells through a record: over many samples at once if it is proved that
no impact occurs, else by rounds of the march. Segment k of a record begins at sample k;
pace is the tau between two samples.

stepper        the pool of lanes, which both steppers share
exact          the stepper of the undamped linear oscillator: exact propagation
taylor_steps   the stepper of every other equation: Taylor steps from sample to sample
"""
