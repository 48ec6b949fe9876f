"""Slower solvers that share no code with the march and check it, one cell (a body under one motion of one A and Omega) at a time.

theta [rad] is the rotation with its sign, positive on the right edge, w its velocity (sqrt(M) theta'), time is tau = p t, and s(phase) the
motion over its amplitude.
"""
