"""The lemmas that the march relies on: statements about a rocking body between two
instants, so that the march need not sample it.

# Setting

On each side of a body y >= 0 is the displacement, in the unit in which the body at rest
falls back with acceleration 1. Time is tau = p t, and y' is a derivative by tau. The
outward drive a is the ground acceleration over its value at uplift. The motion is

    y'' = f - 2 zeta y',    f = -l(y) + a m(y),    l(0) = m(0) = 1,    zeta >= 0.

For the linear oscillator f = y - 1 + a. At y = 0 an impact puts the body on its other
side (or back on the same one) with the speed eta |y'|. A body at rest lifts off where a
> 1 on one of its sides.

# Notation

piece       a part of the motion with one closed form
segment     a part of a piece on which the motion s is monotone
drive       subcritical where a < 1
arc         the Taylor series of y from the present state of a lane, within one piece;
            or the exact flow of the undamped linear oscillator under one sinusoid
step        the part of an arc that one round of the march covers: it turns once at most
turn        an instant at which y' changes its sign
peak        a turning point at which y' changes from positive to negative
A, Omega    amplitude of the drive over its value at uplift; circular frequency of the
            motion over p
e           the strongest inward drive to come (Lemma 6), or a bound that the lemma
            defines
w           the weight over m g, 1 + zg''/g where the ground moves upwards too;
            otherwise 1

**Varying weight.** Where w varies, f = -w l(y) + a m(y), and a body is followed while w
> 0; after that it has lost contact. The *net drive* is c = a + 1 - w; each side has its
own c. A lemma that is used there says what changes when c replaces a.

**Events.** Uplift is the first instant with -A_right s > 1 or A_left s > 1, found on
monotone segments. Lemma 1 isolates the turns of a step; with the signs of y and y' at
its ends it isolates the impact and the peak: each is a root in a bracket that holds
exactly one. Events at one instant are taken in the order impact, jump of the drive,
uplift. Only two turns that are closer than 1e-9 of a step can be missed. Impacts inside
a sequence that Lemma 7 sums are not counted one by one. A body is at rest if its speed
is below 1e-100, or below 1e-12 if it then bounces lower than 1e-16 and keeps more than
1 - 1e-6 of its speed in a cycle.

# Lemma 1 (one turn)

Let b_0 ... b_n be the Bernstein coefficients on [0, 1] of a polynomial p of degree n,
b_0 and b_n not 0. p has as many roots inside, counted with their multiplicity, as b has
changes of sign, or fewer by an even number. So y' of a step has no turn if its
coefficients have one sign, and exactly one if their sign changes once. A step with
several changes is halved: the changes of the two halves together are not more.
Proof. With x = t/(1 + t), (1 + t)^n p = sum b_i C(n, i) t^i for t > 0: this is
Descartes' rule of signs. The coefficients of the halves follow from b by means of
neighbours, which vary no more than b.
A step that has been halved thirty times is taken as it is: two turns in it, closer than
1e-9 of the step, can be missed. They change y by less than rounding. The lemma speaks
of the series, which is the motion to the tolerance of the equation.
Straight lines, whose steps are short: y' and y'' leave their chords between the ends of
a step by no more than the sum of what each term does. There is no turn if y' keeps its
sign so, and one at most if y'' does; the coefficients are computed for the others.
Test
`march/test_roots.py::test_a_part_with_one_turn_at_most_has_the_turns_that_are_said`,
`march/test_one_turn.py::test_a_step_turns_once_at_most_and_every_peak_is_found`,
`march/test_one_turn.py::test_grazing_is_decided_on_either_side`,
`one/test_march.py::test_lemma_1_a_step_is_cut_where_it_may_turn_twice`,
`one/test_march.py::test_lemma_1_holds_for_random_polynomials`.

# Lemma 2 (one turn of an exact flow)

Undamped linear oscillator. Let z be y' where the drive falls, and -y' where it rises.
While the drive is monotone z is negative, positive and negative again at the most: the
signs of z at both ends tell its turns, unless both are negative. Then there is none if
z does not rise at first, or if the tangents at its ends are negative together; other
steps are halved. A body with y' >= 0 and y'' >= 0 under a rising drive moves outwards
until the drive has fallen, and turns once at most on the way.
Proof. z'' = z - |a'| <= z: where z is negative it is concave, so it is below its
tangents and is not negative between two instants at which it is zero. Where the drive
rises, y'' grows by y' + a' and y' by y'': both stay positive.
Test
`march/test_exact.py::test_lemma_2_a_step_turns_once_at_most_and_every_turn_is_found`.

# Lemma 6 (certain overturning)

Linear: let g be the rate of the unstable mode and e the strongest inward drive to come.
A body with z = y - 1 + g v > e never returns.
Proof. z' = g (z + a) > 0 for all time.
Eqs. 2.3 and 3.4, undamped: a body never returns if it moves outwards beyond the barrier
of the constant inward drive e, or has the energy to pass this barrier.
Proof. A weaker drive pushes back less, so the energy over that barrier does not fall.
Damped, nonlinear: only beyond the equilibrium under e. A body at theta = pi/2, or a
collapsed linkage, has overturned. A linkage that locks before is followed up to there,
and a body that comes there is lost if int F + e G from there to any place before the
collapse is below its energy v^2/2, or below 0 with damping or a varying weight; F and G
are those of Eq. 3.4 on the path by a coordinate that goes on.
Varying weight: beyond the equilibrium of the constant inward drive e/w_-, w_- the least
weight to come, and moving outwards: there l < 0 and f >= w_- (-l - m e/w_-) >= 0. The
bounds by energy are not used.
Test
`test_lemmas.py::test_lemma_6_no_drive_up_to_the_strongest_brings_back_what_is_lost`,
`test_lemmas.py::test_lemma_6_calls_lost_what_has_the_speed_to_pass_the_barrier_and_no_less`,
`tests/dynamics/equations/test_locking.py::test_no_drive_of_that_strength_brings_a_body_back_from_the_end`.

# Lemma 7 (the sequence of impacts ends)

A body bounces from side to side within a monotone segment, with a_- <= a <= a_+ until
the end. On the other side the drive is -d a, an arc lasts r times as long and begins
with eta times the speed here; a cycle of two arcs keeps q = eta back of the speed. The
sequence of arcs lasts at most

    2 v / (1 - q) [G/(1 - a_+ - e) + eta r H/(1 + d a_- - e)],

e a bound of the force that y and damping add.
Proof. An arc ends with more speed than it began with only where the force grows, by at
most the root of its last over its first value. Over a monotone drive these ratios
telescope. Where a rises, only arcs on the other side gain: speeds on this side grow by
at most G, G^2 = (1 + d a_+)/(1 + d a_-). Then H = 1, as the force shortens the arcs
there by G^2. Where a falls, G = 1 and H^2 = (1 - a_-)/(1 - a_+). The march follows a
sequence in which an arc could rise above the lane's peak so far.
A one-sided body: the sequence lasts at most 2 v / (1 - eta) / (1 - a_+ - e), and any
inward drive holds the body.
Varying weight: with c and d the net drives on the two sides, it lasts at most 2 v G/(1
- q) [1/(1 - c_+ - e) + eta r/(1 - d_+ - e)]. Speeds gain on either side, by at most the
root of the largest over the least force there; G is the product of both roots, and e
holds w times what y adds.

Test `test_lemmas.py::test_lemma_7_a_summed_sequence_ends_before_anything_else_happens`.

# Lemma 8 (free motion)

On still ground, undamped, the energy between impacts is constant. On a body with equal
sides only the next peak and the next impact matter, on a body with unequal sides the
next two.
Proof. The energy decides the height of an arc. An impact does not raise the speed (eta
<= 1), so later arcs are no higher than the first bounce. On unequal sides two impacts
together do not raise it, so each arc is no higher than the one before on its side.
Damped: the body is marched on until these undamped peaks, which are above its own, are
no higher than its peak so far.
Varying weight: it holds, since the ground is still.
Test `contacts/test_contact.py::test_free_motion_equals_marching`.

# Lemma 9 (nothing overturns below)

Undamped linear oscillator, equal sides: no body overturns while A int |s| dphi <=
Omega. From any instant on, no body overturns if sqrt(E) + A int |s| dphi/Omega < 1 over
what is still to come, E = v^2 + y (2 - y).
Proof. dE/dtau = 2 v a, and v^2 <= E below y = 1, so sqrt(E) grows by at most int |a|
dtau. Impacts lower it. A body that overturns has had E >= 1. Other bodies under a
steady weight: on each edge let W be the speed at the ground of a body that just reaches
its unstable equilibrium, M the largest m, A_1 and Omega_1 the edge's for A = Omega = 1,
and c a unit in which no impact raises the speed. A body at the ground with speed v
does not overturn if c v + A int |s| dphi/Omega max(c A_1 M/Omega_1) < min(c W) over
what is still to come, the maximum and the minimum over the edges.
Proof. The speed at the ground of the same energy grows by at most int |a| M dtau, as
above. Damping and impacts lower it.
Test `test_impulse.py::test_lemma_9_nothing_to_come_overturns_what_is_below_the_bound`,
`tests/envelopes/test_boundaries.py::test_nothing_overturns_where_the_scan_does_not_look_below`.

# Lemma 10 (nothing returns above)

The same oscillator, which the first segment of the motion lifts at any amplitude. Above
an amplitude that overturns without impact every other one does too.
Proof. At a fixed time before the first impact y = A J - K with K > 0 and dy/dA = J, so
y grows with A where it is positive.
Test
`tests/envelopes/test_boundaries.py::test_above_overturning_without_impact_there_is_nothing_else`.

# Lemma 11 (over many samples)

Undamped linear oscillator. While a >= c, y(h) >= y + v sinh h + (y - 1 + c)(cosh h -
1), and no impact comes before this bound is zero. Where y >= 0 and a >= c on a stretch
of length T, y is nowhere above the higher of its ends by more than (1 - c) T^2/8. Where
a <= c' there as well, its end y_1 is its highest point if v_1 >= max(0, y_1 - 1 + c')
T/2, and so is its start y_0 if -v_0 >= max(0, y_0 - 1 + c') T/2.
Proof. Green's function sinh is not negative, so y is monotone in the drive. y'' >= c -
1 gives the bound by the ends. Back from the end, y <= y_1 - v_1 t + t^2/2 max(0, y_1 -
1 + c') as long as y is not above y_1, so it never is; likewise from the start.
Test `march/test_ahead.py::test_flights_end_as_line_by_line`.

# Lemma 13 (contact is kept)

A body whose arcs do not overturn it keeps Fz > 0 if the bound of its speed leaves Fz >
0 on every arc.
Proof. Such an arc begins or ends at rest, at a peak. The work of the strongest inward
push and of the weight over the path between bounds the speed, and the speed bounds Fz
from below (`body` has the formulas). Where this leaves the sign open, Fz >= min(its
ends) - (h^2/8) max |Fz''| on parts of steps that are halved until the sign is
settled. Bounces that Lemma 7 sums: let B be the largest -u'' at the ground on the
way, V the largest speed and u_m the largest u. Then

    Fz/(m g) >= w_- - kappa [(B c + 2 zeta V) sin(alpha) + V^2 cos(alpha - u_m)],
    c = cos(alpha - u_m)/cos(alpha)  (linear: 1)

Proof. -u'' = w sin z - a cos z with z between alpha - u_m and alpha is at most c times
its value at the ground. Ties add to B the most that they pull at u_m, and a tendon adds
to w_- its force at the ground times cos(u_m/2). Bounces for which this is not positive
are followed one by one: their speed falls until it is, or until Fz <= 0 at an impact.
Test `observers/test_contact_watch.py::test_no_body_leaves_the_ground_below_it`,
`observers/test_contact_watch.py::test_they_are_the_cells_whose_least_force_is_not_positive`,
`tied/test_tied_contact.py::test_bounces_that_lose_the_ground_are_followed`.

# Lemma 15 (one outcome of a stretch, of neighbouring amplitudes)

Undamped body of Eq. 2.3, one cycle of a sine, which lifts the body in its first half at
the least amplitude A_0 of a stretch of width d. Let y_0 be the path at A_0 without an
impact, u the outward drive of A = 1, and S >= |sin z| for all paths. With

    Z'' = (1 + A |u| tan(alpha) S) Z + |u|/cos(alpha)

from the uplift of the largest amplitude on, every path without an impact has |y - y_0|
<= d Z and |y' - y_0'| <= d Z'. If y_0 has no impact in the first half, no path of the
stretch has one. None has an impact up to an instant of the second half at which d Z is
below y_0, below y_0 at half the cycle, and below 1. Two bounds of y and two of y' then
decide the outcome: by Lemma 6 at once, or by Lemma 8 when the shaking ends.
Proof. The difference of two paths has |x''| <= (1 + A |u| tan(alpha) S) |x| + d
|u|/cos(alpha), and a comparison gives the bounds. In the first half u >= 0, and y''
grows with A and, up to theta = alpha, with y: so y grows with A, and beyond alpha no
path turns back. In the second half y'' < 0 below alpha, so y_0 is nowhere below the
least of the three values. Where another path first came to the ground d Z would be at
least y_0, but it never falls. To overturn is monotone in y and in y', and so is the
energy of a body that moves back, on either side of alpha.
`stretches` computes y_0 and Z by a Runge-Kutta method, whose error is not bounded: it
adds 15 times the largest one that was found to both distances, and the march still
computes the least amplitude of each stretch.
Test `tests/envelopes/test_stretches.py::test_what_is_proved_is_what_the_march_finds`,
`tests/envelopes/test_stretches.py::test_no_path_is_farther_away_than_the_bound`.

# Lemma 16 (nothing of a stretch of amplitudes overturns)

The same bodies, on either of two edges. For the amplitudes of a stretch, the largest of
which is A, let v be the largest speed at the ground of the energy that one of them has
at some instant, on its first arc and below the equilibrium. With the c, W, M of Lemma
9, of this edge and of both, none of them overturns if

    c v + A int |s| dphi/Omega max(c A_1 M/Omega_1) < min(c W)

over what is still to come.
Proof. Lemma 9 at that instant: the speed at the ground of the energy grows no faster in
the air than at the ground. Lemma 15 bounds v, and shows that no body has had an impact:
in the second half as there; in the first half because the least path is the lowest one,
is above the ground, and once back on it stays below, or because its drive has been
above 1 so far.
From that instant on no body turns farther than its alpha, or faster than a body that
falls from there: with these bounds, and those of Lemma 15 up to that instant, Lemma 13
shows that contact is kept.
Test `tests/envelopes/test_stretches.py::test_nothing_overturns_where_it_is_excluded`.
"""
