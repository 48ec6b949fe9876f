"""Steppers through records: over many samples at once where that is proved free of impacts, rounds of the march elsewhere.

stepper        the pool of lanes, which both steppers share
exact          the stepper of the undamped linear oscillator: exact propagation
bounded        the bounded response to the record, from which the state at any later sample follows at once
stretches      bounds of the samples over stretches of them
taylor_steps   the stepper of every other equation: Taylor steps from sample to sample
weighed_steps  the same where the ground moves upwards too
"""
