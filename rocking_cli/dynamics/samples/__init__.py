"""Steppers through records: over many samples at once where that is proved free of impacts, single intervals where an impact can be.

exact          the stepper of the undamped linear oscillator: exact propagation, intervals, impacts
propagation    the lanes that can be propagated, and how far
bounded        the bounded response to the record, from which the state at any later sample follows at once
stretches      bounds of the samples over stretches of them
peaks          the largest rotation within a propagation
interval       one interval between samples; ramp: the flow within it
taylor_steps   the stepper of every other equation: Taylor steps from sample to sample, rounds of the march where something may happen
weighed_steps  the same where the ground moves upwards too
"""
