"""One body at a time, on plain Python floats: where a person waits for one structure under one motion.

    recurrence  the Taylor recurrence of an equation of motion as text, compiled to straight-line code
    drive       the motion as lists of floats, segment by segment
    lane        what is known beforehand: the sides of a body, its code on each
    body        its state, and its events: uplift, impact, rest, overturning
    march       from event to event, with the proofs of `dynamics` (Lemmas 1, 2, 7, 8 and 12); roots: of the series of a step
    response    outcomes and rotations of cells, one after the other

An array costs a call for every operation, whatever it holds: below a few hundred cells a record is marched sooner on floats. A command,
or a step of its search, chooses this way by what it asks for, so that no bit depends on a cell's neighbours.
"""
