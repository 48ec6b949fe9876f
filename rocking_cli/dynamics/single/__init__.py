"""One body at a time, on plain Python floats: where a person waits for one structure under one motion.

    recurrence    the Taylor recurrence of an equation of motion as text, compiled to straight-line code
    drive_lists   the motion as lists of floats, a block of segments at a time
    lane          the numbers that are known beforehand: the sides of a body, and its code on each
    state         the state of the body, and its events: uplift, impact, rest, overturning
    series_roots  roots of the series of one step: the instant of an impact, and the turning points
    march         the march from event to event, with the proofs of `dynamics` (Lemmas 1, 2, 7, 8 and 12)
    response      outcomes and rotations of cells, one after the other
    scan          approximate falls at many amplitudes of a record: they tell a search where to look, and decide nothing

An array costs a call for every operation, whatever it holds: below a few hundred cells a record is marched sooner on floats. A command,
or a step of its search, chooses this way by what it asks for, so that no bit depends on a cell's neighbours.
"""
