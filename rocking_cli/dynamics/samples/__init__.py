"""Steppers through records: over many samples at once where that is proved free of impacts, rounds of the march elsewhere.

stepper        the pool of lanes, which both steppers share
exact          the stepper of the undamped linear oscillator: exact propagation
taylor_steps   the stepper of every other equation: Taylor steps from sample to sample
"""
