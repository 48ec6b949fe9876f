"""Bodies with ties and a tendon: a separate march, which follows each restraint along
the branches of its force-elongation law. One body alone goes by `one.held_march`.

A device is a tie on one side, or the tendon. A lane is one cell in arrays, (lanes,), at
the displacement y >= 0 on its side, with v = dy/dtau, tau = p t, at the phase u since
the start of segment k of the motion. The drive a is the ground acceleration over its
value at uplift of the free body, positive outward. Under a vertical motion the weight
varies (`weighed_drive`); restraints raise what the net drive must exceed to lift the
body, and a body from which the ground falls away has lost contact, whatever holds it.

    devices     the restraints in the units of an equation: forces, thresholds, the
                coefficients of a branch
    pulls       elongation, lever and moment of devices on their branches
    series      the Taylor series of the motion while no branch changes, and steps with
                one turn at most
    bounces     how strongly a body is held at the ground, and which bounces end in rest
                (Lemma 7)
    tied_lanes  the data of the march: lanes, ends of steps, results
    transitions  restraints from branch to branch: engagement, yield, unloading, slack,
                rupture
    tied_lines   lines of a record along which nothing happens
    cuts        where events end steps
    tied_march  from event to event: transitions, impact, rest, overturning

While no restraint changes its branch (slack, elastic, yielding, broken), the body
follows one smooth equation, and its restoring moment has a closed form. A branch ends
at a rotation that is known beforehand, or at a turn. A step has one turn at most, so
the signs at its ends and at the turn decide whether it meets the rotation. Of the
lemmas for the free body only Lemma 7 is used (`bounces`).
"""
