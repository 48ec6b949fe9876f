"""How much of several verdicts is known, for a line of progress."""

from collections.abc import Callable
from functools import partial


class KnownShares:
    """The shares of several verdicts that are known; `tell` is called with their sum
    whenever it grows."""

    def __init__(self, count: int, tell: Callable[[float], None]) -> None:
        self._shares = [0.0] * count
        self._tell = tell

    def _grow(self, number: int, share: float) -> None:
        if share > self._shares[number]:
            self._shares[number] = share
            self._tell(sum(self._shares))

    def of(self, number: int) -> Callable[[float], None]:
        """Return a function that takes the share of one verdict."""
        return partial(self._grow, number)

    def all(self, share: float) -> None:
        """Take a share of all verdicts."""
        for number in range(len(self._shares)):
            self._grow(number, share)
