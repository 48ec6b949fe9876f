"""The contact of a body with the ground: where it lifts off, what an impact does, how
bounces and the free motion end.
"""
