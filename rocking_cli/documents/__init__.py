"""Documents that users write (YAML, JSON, CSV): text to checked values in SI units,
each with its file, line and column.
"""
