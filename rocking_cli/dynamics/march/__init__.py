"""The march takes cells from event to event. In a window the drive stays below 1, or at
1 and above; a closing is a proof that ends the march of a lane.
"""
