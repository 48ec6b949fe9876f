"""Observers follow the motion of a run: they find the largest speed and the lost
contact of each cell. An arc is the motion of a lane over one step. In formulas of
forces u is |theta| [rad]; a push is the ground acceleration over g, positive outward.
"""
