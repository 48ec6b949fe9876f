"""What rocks, as the march takes it: an equation of motion and a contact."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..motions.motion import Motion
from .contacts.contact import Contact
from .contacts.symmetric import Symmetric
from .equations.equation import Equation

_SYMMETRIC = Symmetric()


@dataclass(frozen=True)
class System:
    """An equation of motion on a contact; `Symmetric` unless given."""

    equation: Equation
    contact: Contact = _SYMMETRIC

    def least_uplift(self, motion: Motion) -> float:
        """The amplitude A from which a motion lifts the body [-]; infinite where it never does."""
        one = self.contact.cells(self.equation, np.ones(1), np.ones(1), np.zeros(1))
        strongest = float(self.contact.strongest(one, motion.segments)[0])
        return 1.0 / strongest if strongest > 0.0 else math.inf
