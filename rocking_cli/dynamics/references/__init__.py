"""Slower solvers that share no code with the march and check it, one cell at a time.
theta [rad] is the rotation with its sign, positive on the right edge, w its velocity
(sqrt(M/M0) theta').
"""
