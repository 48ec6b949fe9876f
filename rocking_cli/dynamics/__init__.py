"""How a structure answers a motion: an equation of motion on a contact with the ground, marched from event to event.

    equations/   the forms of y'' = f - 2 zeta y': linear, rigid body, mechanism; their exact flows, Taylor series and collocation
    contacts/    where a body lifts off, what an impact does, when bouncing ends: two sides alike, two sides unequal, one side
    march/       the engine: a run of lanes, windows of the drive, steps, roots; closings, which end lanes whose outcome is proved
    flight/      steppers through records: jumps and Taylor steps over samples that are proved free of impacts
    observers/   who looks on at a run: peak speed, ground forces (to 1e-6), contact loss (proved)
    references/  slower paths to the same answer that share nothing with the march
    body         a rigid body as its forces see it, and from which motions it is proved to press on the ground
    lanes        the state of many bodies; drive: its value along a motion; on these all the rooms rest
    method       which equation answers for which structure; system: an equation on a contact; response: the front door

**Words.** A motion is made of *pieces* (one closed form each) and cut into *segments* (s monotone). A *window* is a stretch of the
drive on which one sign test holds, a *valley* (a < 1) or a *ridge* (a >= 1). A *step* is what a round of the march covers with one
proof: a window, or a ridge left outwards and the valley after it. An *arc* is the motion of a lane along one *flow*; a *passage* is
what a step comes to; a *crest* is a turning point outwards. *Uplift*: a body at rest leaves the ground; lambda is the acceleration
(over g) at which it does, and the uplift amplitude the A. *Bouncing* (chatter) is a series of ever smaller arcs that ends in rest.

**The setting.** On a side, y >= 0 is the displacement in the unit in which the body at rest falls back with acceleration 1, tau = p t,
a the outward drive over its value at uplift, f = -l(y) + a m(y), l(0) = m(0) = 1, l/m > 1 below the ground, zeta >= 0. For the linear
oscillator f = y - 1 + a. With damping, Y = exp(zeta tau) y and V = exp(zeta tau) y' have the signs of y and y' and, for the linear
oscillator, Y'' - (1 + zeta^2) Y = exp(zeta tau) (a - 1) and V'' - (1 + zeta^2) V = exp(zeta tau) a': each lemma is proved on them as on
y and y' without damping.

Lemma 1 (valley). While a < 1 a body that has crossed y = 0 downwards does not come back: f < 0 for y <= 0, and at y' = 0 it only falls.
    So y > 0 at the end of a valley proves that there was no impact, y <= 0 that there was exactly one.
Lemma 2 (ridge). While a >= 1 and y >= 0, y' = 0 implies y'' >= 0: with y' >= 0 at the start nothing happens; with y' < 0 there is at
    most one minimum, and its sign decides. Undamped, y is convex there, so it lies above the point where the tangents at its ends meet.
Lemma 3 (one crest). In a valley, or a ridge left outwards and its valley, where a falls and then rises at most once, y' goes from
    positive to negative at most once: where a' < 0, V is concave while negative, and where a' > 0, convex while positive.
Lemma 4 (hidden turn). The same convexity finds a pair of turns that hide between two ends of one sign: the slope of V says on which
    side its extremum lies, and its tangents prove that there is none. For Eqs. 2.3 and 3.4 this needs f to grow with y; on stocky
    bodies under strong inward drives (a tan(alpha) tan(z) < -1) it may not, and there a pair of turns within one window can be missed: it
    changes no outcome, only a lower crest's height.
Lemma 5 (low bounce). A bounce from impact to impact in a valley, undamped, with g v h < 1 - max a (g the gain, v its first speed, h its
    length) is concave, and so below the point where the tangents at its ends meet.
Lemma 6 (certain overturning). Linear: beyond z = y - 1 + g v = e, g the rate of the unstable mode and e the strongest inward drive to
    come, z' = g (z + a) > 0 for good. Eqs. 2.3 and 3.4, undamped: moving outwards beyond the barrier of the constant inward drive e,
    or with the energy to pass it, since a weaker drive pushes back less and the energy over that barrier does not fall; damped: beyond
    its equilibrium only. theta = pi/2, or a collapsed linkage, is overturning whatever comes.
Lemma 7 (end of bouncing). See `contacts.contact.bouncing_ends`: bounds on the sum of the series, inside one monotone segment; and
    `contacts.settling`: bouncing to the end of the shaking that nothing lifts again (under a record `contacts.adiabatic`, Lemma 14);
    `contacts.trains`: more bounces than the march follows.
Lemma 8 (fate). On still ground, undamped, the energy between impacts is constant; on a body with equal sides only the next crest and the
    next impact matter, on an unequal one the next two. Damped bodies are marched on until these, which damping only lowers, come to no
    more than the peak so far.
Lemma 9 (nothing overturns below). Linear, undamped, equal sides: with E = v^2 + y (2 - y), dE/dtau = 2 v a and v^2 <= E below y = 1, so
    sqrt(E) grows by at most int |a| dtau and impacts lower it; a body that overturns has had
    E >= 1. So none does while A int |s| dphi <= Omega, nor from any instant on where sqrt(E) + A int |s| dphi/Omega of what is still to
    come is below 1 (`impulse`).
Lemma 10 (nothing returns above). The same oscillator, lifted on the motion's first segment at any amplitude: at a fixed time
    y = A J - K with K > 0 and dy/dA = J before the first impact, so where y > 0 it grows with A, and above an amplitude that overturns
    without impact every other does, and above one whose first arc outlasts the shaking every other one's does too: there the modes
    y - 1 + v and v + 1 - y at its end are convex in A (see `envelopes.one_arc`).
Lemma 11 (flight). Linear, undamped: Green's function sinh is not negative, so y is monotone in the drive: while a >= c,
    y(h) >= y + v sinh h + (y - 1 + c)(cosh h - 1), and no impact comes before that bound is zero; while a <= c the same is a bound from
    above. Where y > 0 and a >= c on a stretch of length T, y'' >= c - 1, and y is nowhere above the higher of its ends by more than
    (1 - c) T^2/8. Where such a bound of y and the largest a leave y'' < 0, v falls throughout and a crest is the only one (`flight.crest`).
    The state at the end of a stretch is exact (see `flight.bounded`), whatever happens on the way.
Lemma 12 (stride). Any equation: on 0 <= y <= limit f >= -K, K = L + M max(0, -a), L and M the largest l and m and a the least drive of a
    stretch of length h; so that y'' + 2 zeta y' >= -K. While y + (y' - zeta h |y'|) h -
    K h^2/2 > 0 no impact comes. No crest is above the higher end by more than exp(2 zeta h) K h^2/8, since from the crest y falls at most
    by exp(2 zeta s) K s^2/2 to an end s away; there is none where y' (1 - 2 zeta h) >= K h at the start, or y' <= -K h at the end.

**A weight that varies.** Ground that moves upwards too makes the weight w = 1 + zg''/g of m g and f = -w l(y) + a m(y); bodies are followed
while w > 0, and then have lost contact. With the *net drive* c = a + 1 - w in the place of a, on each side its own (`weight`):
Lemmas 1 and 2 hold: f = m (a - w l/m), and below the ground w l/m > w > a where c < 1, above it w l/m <= w <= a where c >= 1.
Lemmas 3 and 4 do not, since a' + w' (y - 1) has no sign to begin with: turns are isolated on the series itself (`march.turns`).
Lemma 5 holds with w_+ g in the place of g, w_+ the largest weight: c is largest at an end of the valley, and f <= c - 1 + w_+ g y.
Lemma 6: beyond the equilibrium of the constant inward drive e/w_- and moving outwards nothing returns, w_- the least weight to come:
    there l < 0 and f >= w_- (-l - m e/w_-) >= 0. The bounds by energy are not used. Lemma 7 holds with both net drives
    (`contacts.contact.bouncing_weighed`); 8 does, since the ground is still; 9, 10 and 11 are not used.
Lemma 12 holds with w_+ L in the place of L, w_+ the largest weight of a stretch on which w > 0.

Lemma 13 (pressing). Every arc that does not overturn the body begins or ends at rest, at a crest, so that the work of the strongest inward
    push and the weight over the path between bounds the speed, and the speed Fz from below (`body`). Where that leaves Fz > 0 open,
    Fz >= min(its ends) - (h^2/8) max |Fz''| on stretches of the march that are halved until it is settled (`observers.contact_loss`).
Lemma 14 (one action). Undamped, equal sides, a record that lifts the body no more: between impacts d/dtau [y'^2/2 + L - a M] = -a' M, L
    and M the integrals of l and m. Low and quick bounces under a slow drive keep W^(3/2)/(1 - a^2), W their energy at the ground, but for
    what the bends and slopes of the drive do within a bounce, which is summed (see `contacts.adiabatic`).

**Events.** Uplift is found as the first instant with -A_right s > 1 or A_left s > 1 on monotone segments, impacts by Lemmas 1 and 2,
crests by Lemmas 3 and 4, each as a root in a bracket that holds exactly one. What falls on one instant is taken in the order impact, jump
of the drive, uplift. Nothing is sampled. What can be missed: the pair of turns of Lemma 4; impacts inside bouncing that is summed are not
counted one by one; a body slower than 1e-12 that bounces lower than 1e-16 and keeps more than 1 - 1e-6 of its speed in a cycle, and
one slower than 1e-100 in any case, is at rest.
"""
