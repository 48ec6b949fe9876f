"""Bodies with ties and a tendon: a march of its own, along the phases of their restraints.

    devices     the restraints in the units of an equation: forces, thresholds, the coefficients of a phase
    series      the Taylor series of a phase, steps with one turn at most, and the work of a phase
    tied_lanes  what the march carries
    tied_march  from event to event: engagement, yield, unloading, slack, rupture, impact, rest, overturning

Within one phase of all its restraints a body follows one smooth equation, whose restoring moment is known in closed form. Each end of a
phase is a rotation that is known beforehand, or a turn. A step has one turn at most, so the signs at its ends and at the turn decide
whether it meets the rotation. The lemmas of the free body are not used, but that of bouncing (`tied_march`).
"""
