"""The march of many bodies: `advance` takes a step with one turn at most, `roots` finds
the impact and the peak in it, `engine` is the loop over steps, `proofs` ends lanes
whose outcome is known. `exact` takes the step of the undamped linear oscillator.
`whole_lines` and `over_samples` take bodies in the air over lines of a record.
"""
