"""Bodies with ties and a tendon: a march of its own, along the phases of their restraints.

    devices     the restraints in the units of an equation: forces, thresholds, the coefficients of a phase
    series      the Taylor series of a phase, and its monotone stretches
    tied_lanes  what the march carries
    tied_march  from event to event: engagement, yield, unloading, slack, rupture, impact, rest, overturning

Within one phase of all its restraints a body follows one smooth equation, whose restoring moment is known in closed form. Each end of a
phase is a rotation that is known beforehand, or a turn. A step ends at the first turn, so y is monotone on it and the sign at its end
decides whether it meets the rotation. The lemmas of the free body are not used, but that of bouncing (`tied_march`).
"""
