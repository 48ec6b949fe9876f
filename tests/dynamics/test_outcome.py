"""Outcomes: codes, words and predicates."""

import numpy as np

from rocking_cli import Outcome, overturned, safe
from rocking_cli.reports.figures.colours import COLOURS, SIGNS


def test_a_failed_or_missing_cell_is_neither_safe_nor_overturned():
    assert {
        o.flag: (int(o), o.safe, o.overturned, o.mode) for o in Outcome
    } == {  # mode: the word of an envelope's interval
        "not_computed": (0, False, False, "not_computed"),
        "no_uplift": (1, True, False, "no_uplift"),
        "rocked": (2, True, False, "rocked"),
        "overturned_no_impact": (3, False, True, "no_impact"),
        "overturned_after_impact": (4, False, True, "after_impact"),
        "failed": (5, False, False, "failed"),
        "lost_contact": (6, False, False, "lost_contact"),
        "leaning": (7, False, False, "leaning"),
        "slid": (8, True, False, "slid"),
    }
    codes = np.array([[0, 1, 2], [3, 4, 5]], dtype=np.uint8)
    assert safe(codes).tolist() == [[False, True, True], [False, False, False]]
    assert overturned(codes).tolist() == [[False, False, False], [True, True, False]]
    assert (overturned(4), overturned(np.uint8(5))) == (True, False)
    assert len({o.sentence for o in Outcome}) == len(Outcome)
    for looks in (COLOURS, SIGNS):
        assert list(looks) == list(Outcome)
        assert len(set(looks.values())) == len(Outcome)
    assert all(len(sign) == 1 for sign in SIGNS.values())
