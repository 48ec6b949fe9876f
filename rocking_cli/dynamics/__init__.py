"""The response of a structure to a motion: an equation of motion on a contact with the ground, marched from event to event.

`response` is the front door, `march.engine` the loop; `lemmas` states and proves what the march relies on.
"""
