"""How much of several verdicts is known, for a line of progress."""

from collections.abc import Callable
from functools import partial


class KnownShares:
    """The shares of several verdicts that are known; `tell` is called with their sum
    whenever it grows."""

    def __init__(self, count: int, tell: Callable[[float], None]) -> None:
        self._shares = [0.0] * count
        self._tell = tell

    def grow(self, number: int, share: float) -> None:
        """Take the share of one verdict."""
        if share > self._shares[number]:
            self._shares[number] = share
            self._tell(sum(self._shares))

    def of(self, number: int) -> Callable[[float], None]:
        """Return a function that takes the share of one verdict."""
        return partial(self.grow, number)
