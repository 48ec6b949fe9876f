"""The march through records: long jumps that are proved free of impacts, single intervals where an impact can be.

windows  bounds of the samples over stretches of them
bounded  the bounded response to the record, from which the state at any later sample follows at once
ramp     the flow within one interval between samples
jump     the lanes that can jump, and how far
crest    the largest rotation within a jump
run      the engine of the undamped linear oscillator: jumps, intervals, impacts
walk     that of every other equation: strides from sample to sample, rounds of the march where something may happen
weighed_walk  the walk where the ground moves upwards too
"""
