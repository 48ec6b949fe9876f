"""One body at a time, on plain Python floats: for commands in which a person waits for
one structure under one motion.

    lane          what the march does not change: the motion as lists of floats, the
                  edges of a body, and its equation on each
    state         the state of the body, and its events: uplift, impact, rest,
                  overturning
    series_roots  roots of the series of one step: the instant of an impact, and the
                  turning points
    straight_lines  the drive and the series along whole lines of a record
    march         the march from event to event, with the proofs of `dynamics` (Lemmas
                  1, 2, 7, 8 and 12)
    one_by_one    outcomes and rotations of cells, one after the other

Every operation on an array costs a call: below a few hundred cells the march under a
record is faster on floats. A command, or a step of its search, chooses by the kind of
its question, so that no bit depends on the other cells.
"""
