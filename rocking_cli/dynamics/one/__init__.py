"""One body at a time, on plain Python floats: for commands in which a person waits for
one structure under one motion.

    motion_lists  the motion as lists of floats
    lane          what the march does not change: the edges of a body and its equation
                  on each, for any amplitude
    step          one step: the Taylor series of y as far as it holds, with one turn at
                  most
    state         the state of the body, and its end (Lemmas 6 and 8)
    free_march    the march from event to event (Lemmas 1 and 7)
    lane_restraints
                  ties and a tendon on each branch of their force laws
    held_state    the state of a body with restraints, and its end
    held_march    its march, which ends steps at ends of branches too
    march         of either
    one_by_one    outcomes and rotations of cells, one after the other

Every operation on an array costs a call: below a few hundred cells the march under a
record is faster on floats. A command, or a step of its search, chooses by the kind of
its question, so that no bit depends on the other cells.
"""
