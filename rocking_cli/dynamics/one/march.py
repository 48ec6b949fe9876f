"""The march of one body on floats, free or with ties and a tendon."""

from .free_march import March
from .lane import Lane
from .state import Ended, Listener


def march(
    lane: Lane,
    amplitude: float,
    *,
    peaks: bool = True,
    listener: Listener | None = None,
    release: float = 0.0,
) -> Ended:
    """The outcome of a body under A = amplitude, from rest or released to the right
    from theta/alpha = release.

    peaks: True if the largest rotation is wanted.
    """
    kind: type[March] = March
    if lane.restraints is not None:
        from .held_march import HeldMarch

        kind = HeldMarch
    return kind(lane, amplitude, peaks, listener).run(release)
