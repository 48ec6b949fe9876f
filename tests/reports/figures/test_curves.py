"""Responses, comparisons and families, read back from the figure that
would be saved.
"""

import math
from itertools import pairwise

import numpy as np
import pytest
from support.axes import lines, numbers, same

from rocking_cli import UsageError, load_structures, read_documents
from rocking_cli.reports.figures.histories import with_jumps
from rocking_cli.reports.units import parse_units

KEYS = ("p", "alpha", "eta", "lambda")
SPIRES = (
    "params",
    "configs/spire.yaml",
    "--vary",
    "base_radius=1:2:4",
    "--vary",
    "height=8:16:3",
)


@pytest.mark.parametrize(
    ("extra", "x", "y", "ground", "labels"),
    [
        (
            ("--model", "both"),
            "t",
            ("theta_linear", "theta_nonlinear"),
            "ground_acceleration",
            ("time $t$ [s]", r"rotation $\theta$ [rad]", r"$\ddot{x}_g$ [g]"),
        ),
        (
            ("--dimensionless",),
            "tau",
            ("theta_ratio",),
            "A",
            (r"$p\,t$ [-]", r"$\theta/\alpha$ [-]", r"$A\,s$ [-]"),
        ),
    ],
)
def test_a_response_stands_above_its_motion(drawn, table, extra, x, y, ground, labels):
    source, rows = table(
        "response", "configs/block.yaml", "--A", "2", "--Omega", "4", *extra
    )
    axes, below = drawn(source).axes
    for line, column in zip(axes.get_lines(), y, strict=True):
        same(line.get_data(), numbers(rows, x), numbers(rows, column))
    unit = 9.81 if x == "t" else 1.0
    same(
        below.get_lines()[0].get_data(), numbers(rows, x), numbers(rows, ground) / unit
    )  # a sine does not jump
    assert (below.get_xlabel(), axes.get_ylabel(), below.get_ylabel()) == labels
    title = "Column, one cycle of a sine, A = 2 at Omega = 4, linear equation"
    if x == "tau":
        assert axes.get_title() == title
    words = [text.get_text() for text in drawn(source).legends[0].get_texts()]
    assert words == [
        *(["linear equation", "nonlinear equation"] if x == "t" else ["response"]),
        *("uplift", "impact", "falls"),
        r"$\pm\alpha$",
    ]


def test_forces_stand_between_the_response_and_its_motion(drawn, table):
    source, rows = table(
        "response", "configs/block.yaml", "--A", "2", "--Omega", "4", "--forces"
    )
    figure = drawn(source)
    axes, between, below = figure.axes
    assert len(axes.get_lines()) == 1
    for line, name in zip(between.get_lines(), ("fx_ratio", "fz_ratio"), strict=True):
        t, force = line.get_data()
        upright = np.flatnonzero(np.diff(t) == 0.0) + 1  # a point more at each impact
        same(
            (np.delete(t, upright - 1), np.delete(force, upright - 1)),
            numbers(rows, "t"),
            numbers(rows, name),
        )
    assert [text.get_text() for text in between.get_legend().get_texts()] == [
        "$F_x/mg$",
        "$F_z/mg$",
    ]
    figure.get_layout_engine().execute(figure)
    for panel in (axes, between, below):  # no label runs into the panel beside it
        label = panel.yaxis.label.get_window_extent()
        assert panel.get_window_extent().height > label.height


def test_a_motion_jumps_upright(drawn, table):
    call = (
        "response",
        "configs/block.yaml",
        "--pulse",
        "rectangular-impulse",
        "--a-g",
        "0.26g",
        "--T-g",
        "0.4",
        "--duration",
        "3",
    )
    source, _ = table(*call)
    t, a = drawn(source).axes[1].get_lines()[0].get_data()
    upright = np.flatnonzero(np.diff(t) == 0.0)
    np.testing.assert_allclose(
        [(a[i], a[i + 1]) for i in upright], [(0.26, -0.13), (-0.13, 0)], rtol=1e-12
    )
    assert t[upright] == pytest.approx([0.4, 1.2], abs=3.0 / 500)
    assert not np.any((np.diff(t) > 0.0) & (np.abs(np.diff(a)) > 1e-12))


def test_only_jumps_are_upright():
    t = np.linspace(0, 1, 50)
    assert with_jumps(t, np.sin(7 * t))[0].size == 50
    assert with_jumps(t, np.where(t < 0.5, 1.0, 0.0))[0].size == 51
    assert with_jumps(t[:1], t[:1])[0].size == 1


def test_units_are_those_asked_for(drawn, table):
    source, rows = table(
        "response", "configs/block.yaml", "--A", "2", "--Omega", "4", "--units", "deg,g"
    )
    axes, below = drawn(source, units=parse_units("mrad,m/s2")).axes
    np.testing.assert_allclose(
        axes.get_lines()[0].get_ydata(),
        1e3 * np.radians(numbers(rows, "theta")),
        rtol=1e-12,
    )
    np.testing.assert_allclose(
        below.get_lines()[0].get_ydata(),
        9.81 * numbers(rows, "ground_acceleration"),
        rtol=1e-12,
    )
    assert (axes.get_ylabel(), below.get_ylabel()) == (
        r"rotation $\theta$ [mrad]",
        r"$\ddot{x}_g$ [m/s²]",
    )


def test_a_comparison_collapses_from_left_to_right(drawn, table):
    call = (
        "compare",
        "configs/block.yaml",
        "configs/spire.yaml",
        "--A",
        "2",
        "--Omega",
        "4",
        "--eta",
        "0.8",
        "--curves",
    )
    source, rows = table(*call)
    ground, left, right = drawn(source).axes
    assert ground.get_ylabel() == r"$\ddot{x}_g$ [g]"
    assert set(lines(left)) == {"Column, linear", "Spire, linear"}
    for name in ("Column", "Spire"):
        mine = [r for r in rows if r["structure"] == name]
        same(
            lines(ground)[f"{name}, linear"],
            numbers(mine, "t"),
            numbers(mine, "ground_acceleration") / 9.81,
        )
        same(lines(left)[f"{name}, linear"], numbers(mine, "t"), numbers(mine, "theta"))
        same(
            lines(right)[f"{name}, linear"],
            numbers(mine, "tau"),
            numbers(mine, "theta_ratio"),
        )
    heights = [
        [np.abs(y).max() for _, y in lines(axes).values()] for axes in (left, right)
    ]
    assert max(heights[0]) > 1.2 * min(heights[0])
    assert max(heights[1]) == pytest.approx(min(heights[1]), rel=1e-3)
    assert math.isfinite(heights[0][0])


def test_a_family_is_its_parameters_over_the_first_key_and_a_line_for_each_second_value(
    drawn, table
):
    source, rows = table(*SPIRES)
    figure = drawn(source)
    assert [a.get_xlabel() for a in figure.axes] == [
        "",
        "",
        "base radius [m]",
        "base radius [m]",
    ]
    assert [a.get_ylabel() for a in figure.axes] == [
        "$p$ [rad/s]",
        r"$\alpha$ [rad]",
        r"$\eta$ [-]",
        r"$\lambda$ [-]",
    ]
    for axes, key in zip(figure.axes, KEYS, strict=True):
        found = lines(axes)
        assert list(found) == ["height = 8 m", "height = 12 m", "height = 16 m"]
        for label, line in found.items():
            mine = [r for r in rows if float(r["height"]) == float(label.split()[2])]
            same(line, numbers(mine, "base_radius"), numbers(mine, key))


def test_one_key_over_another_is_a_slenderness_on_which_spires_collapse(drawn, table):
    source, rows = table(*SPIRES)
    figure = drawn(source, over="base_radius/height")
    assert figure.axes[2].get_xlabel() == "base radius / height [-]"
    for label, line in lines(figure.axes[1]).items():
        mine = [r for r in rows if float(r["height"]) == float(label.split()[2])]
        same(
            line,
            numbers(mine, "base_radius") / numbers(mine, "height"),
            numbers(mine, "alpha"),
        )
        np.testing.assert_allclose(
            line[1], np.arctan(3 * line[0]), rtol=1e-12
        )  # Eq. 3.1
    with pytest.raises(
        UsageError,
        match=(
            "`over`: found 'width'; expected base_radius, height, or one over another"
        ),
    ):
        drawn(source, over="width")


def test_a_line_is_broken_where_the_mechanism_changes(drawn, table):
    source, rows = table(
        "params", "configs/arch.yaml", "--vary", "thickness=1.45:1.75:7"
    )
    figure = drawn(source)
    assert [a.get_ylabel() for a in figure.axes][:5] == [
        "$p$ [rad/s]",
        r"$\alpha$ [rad]",
        r"$\eta$ [-]",
        r"$\lambda$ [-]",
        "$a_{scale}$ [-]",
    ]
    (line,) = figure.axes[1].get_lines()
    x, y = line.get_data()
    # Of seven voussoirs the second hinge moves from 67.5 to 45 degrees between 1.6 and
    # 1.65 m.
    changed = [
        float(a["hinges_2_angle"]) != float(b["hinges_2_angle"])
        for a, b in pairwise(rows)
    ]
    assert changed == [False, False, False, True, False, False]
    np.testing.assert_array_equal(np.isnan(y), [False] * 4 + [True] + [False] * 3)
    same(
        (x[~np.isnan(x)], y[~np.isnan(y)]),
        numbers(rows, "thickness"),
        numbers(rows, "alpha"),
    )


def test_a_varied_angle_keeps_the_unit_of_the_option(drawn, table):
    source, _ = table("params", "block:radius=1,alpha=10deg", "--vary", "alpha=10:20:3")
    axes = drawn(source).axes
    assert axes[2].get_xlabel() == "alpha varied [deg]"
    np.testing.assert_allclose(
        axes[1].get_lines()[0].get_xdata(), [10, 15, 20], rtol=1e-14
    )


def test_what_was_not_varied_is_no_family(drawn):
    with pytest.raises(
        UsageError, match="a family is drawn over the keys that were varied"
    ):
        drawn("name,p,alpha,eta,lambda\nx,1,1,1,1\n")


def test_several_responses_are_in_one_panel_with_a_dash_for_each_equation(
    drawn, table, tmp_path
):
    names = []
    for t in ("0.36", "0.44"):
        call = (
            "response",
            "configs/arch.yaml",
            "--pulse",
            "rectangular-impulse",
            "--a-g",
            "1g",
            "--T-g",
            t,
            "--model",
            "both",
        )
        names.append(table(*call, "--duration", "1")[0].rename(tmp_path / f"t{t}.csv"))
    axes, below = drawn(names).axes
    looks = {
        line.get_label(): (line.get_color(), line.get_linestyle())
        for line in axes.get_lines()
    }
    assert looks == {
        f"t{t}, {m} equation": (f"C{i}", ls)
        for i, t in enumerate(("0.36", "0.44"))
        for m, ls in (("linear", "-"), ("nonlinear", "--"))
    }
    assert len(below.get_lines()) == 2
    first = drawn(names, align=True).axes[0].get_lines()[0]  # comes back before alpha
    assert np.abs(first.get_ydata()).argmax() == np.abs(first.get_xdata()).argmin()
    with pytest.raises(UsageError, match="several CSV of rocking response"):
        drawn([names[0], table(*SPIRES)[0]])


@pytest.mark.parametrize("extra", [("--json",), ("--dimensionless", "--csv")])
def test_a_phase_portrait_has_the_separatrix_inside_which_a_body_comes_back(
    drawn, rocking, extra
):
    """A body released inside the separatrix stays inside it: (1 - |x|)^2 - y^2 is
    constant up to an impact.
    """
    free = (
        "response",
        "block:0.5x2,restitution=0.9",
        "--release",
        "0.8",
        "--model",
        "linear",
        "--duration",
        "3",
    )
    (axes,) = drawn(rocking(*free, *extra).stdout, portrait=True).axes
    path, _, separatrix, *_ = axes.get_lines()
    x, y = path.get_data()
    assert (x[0], y[0]) == pytest.approx((0.8, 0.0), abs=1e-12)
    assert np.all(np.abs(x) + np.abs(y) < 1.0)
    before = np.cumsum(x <= 0.0) == 0
    assert ((1.0 - x) ** 2 - y**2)[before] == pytest.approx(0.04, rel=1e-9)
    assert np.add(*separatrix.get_data()) == pytest.approx(1.0, rel=1e-6)
    assert (
        axes.get_title() == "block:0.5x2 restitution=0.9, free rocking, linear equation"
    )
    assert axes.get_ylabel() == r"$\dot\theta/(p\,\alpha)$ [-]"


def test_a_portrait_has_the_separatrix_of_its_own_equation(drawn, rocking):
    """Without a document of the block with p and alpha of the response: (theta_dot/p)^2
    = 2 (1 - cos(alpha - theta)) at the level of the unstable equilibrium.
    """
    call, alpha = (
        ("response", "block:0.5x2", "--a-g", "0.3g", "--f-g", "1", "--duration", "2"),
        np.arctan(0.25),
    )
    (axes,) = drawn(rocking(*call, "--csv").stdout, portrait=True).axes
    x, y = axes.get_lines()[2].get_data()
    np.testing.assert_allclose(
        (alpha * y) ** 2, 2.0 * (1.0 - np.cos(alpha * (1.0 - x))), atol=1e-8
    )
    assert axes.get_lines()[2].get_label() == "separatrix of a block"
    (rigid,) = load_structures("configs/rigid.yaml")
    csv = rocking(
        "response", "configs/rigid.yaml", "--a-g", "0.5g", "--f-g", "1.2", "--csv"
    ).stdout
    with pytest.raises(UsageError, match="sides differ"):
        drawn(csv, portrait=True)
    (axes,) = drawn(
        csv, portrait=True, body=read_documents("configs/rigid.yaml")[0]
    ).axes
    for side, line in zip(
        reversed(rigid.sides), axes.get_lines()[2::2], strict=True
    ):  # speeds over alpha of the side and p of the body
        x, y = line.get_data()
        np.testing.assert_allclose(
            (side.alpha * y * rigid.p / side.p) ** 2,
            2 * (1 - np.cos(side.alpha * (1 - np.abs(x)))),
            atol=1e-8,
        )


def test_the_least_amplitude_of_a_check_is_drawn_over_a_varied_key(drawn, table):
    source, rows = table(
        "check",
        "block:radius=1,alpha=10deg",
        "--a-g",
        "0.3g",
        "--f-g",
        "2",
        "--a-max",
        "3",
        "--vary",
        "alpha=10:14:3",
    )
    (axes,) = drawn(source, over="alpha").axes
    assert (axes.get_xlabel(), axes.get_ylabel()) == (
        "alpha [rad]",
        "first overturning a [g]",
    )
    curve, demand = axes.get_lines()
    same(
        curve.get_data(),
        numbers(rows, "varied_alpha"),
        numbers(rows, "first_overturning_a") / 9.81,
    )
    assert (demand.get_label(), demand.get_ydata()[0]) == ("demand", pytest.approx(0.3))


@pytest.mark.slow
def test_the_least_amplitude_of_an_envelope_is_drawn_for_each_frequency_over_a_quotient(
    drawn, table
):
    call = (
        "envelope",
        "block:0.3x2",
        "--grid",
        "f_g=1:2:2",
        "--a-max",
        "4",
        "--pulse",
        "rectangular",
        "--vary",
        "width=0.3:0.5:3",
        "--vary",
        "height=2:3:2",
    )
    source, rows = table(*call, "--model", "linear")
    (axes,) = drawn(source, over="width/height").axes
    assert axes.get_xlabel() == "width / height [-]"
    found = lines(axes)
    assert sorted(found) == [
        f"height = {h} m, $f_g$ = {f} Hz" for h in (2, 3) for f in (1, 2)
    ]
    for label, line in found.items():
        height, frequency = float(label.split()[2]), float(label.split()[-2])
        mine = [
            r
            for r in rows
            if float(r["varied_height"]) == height
            and abs(float(r["omega_g"]) - frequency * 2 * np.pi) < 1e-9
        ]
        least = [
            min(numbers([r for r in mine if float(r["varied_width"]) == w], "a_from"))
            for w in (0.3, 0.4, 0.5)
        ]
        same(line, np.array([0.3, 0.4, 0.5]) / height, np.array(least) / 9.81)


def test_free_rocking_has_no_panel_of_the_ground_and_ends_soon_after_its_rest(
    drawn, table
):
    source, rows = table("response", "block:0.5x2", "--release", "0.2")
    (axes,) = (a for a in drawn(source).axes if a.get_xlabel())  # one has no label
    moving = [float(r["t"]) for r in rows if abs(float(r["theta_ratio"])) > 1e-9]
    assert axes.get_xlim()[1] == pytest.approx(1.1 * moving[-1], rel=0.02)
    assert axes.get_xlim()[1] < 0.9 * float(rows[-1]["t"])
