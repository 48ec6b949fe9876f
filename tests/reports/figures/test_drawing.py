"""Drawings by what they draw, read back from the figure that would be saved."""

import math

import numpy as np
import pytest

from rocking_cli import (
    DocumentError,
    Look,
    draw_structures,
    parse_documents,
    read_documents,
)
from rocking_cli.reports.figures.labels import Ink, spaced
from rocking_cli.reports.units import parse_units


@pytest.fixture
def structures_drawn(figures, tmp_path, pytestconfig):
    """A function that draws shipped documents and returns the panels."""

    def run(*names, **options):
        documents = [
            d
            for name in names
            for d in read_documents(pytestconfig.rootpath / "configs" / f"{name}.yaml")
        ]
        draw_structures(documents, tmp_path / "figure.png", **options)
        return figures[-1].axes

    return run


def labelled(axes, label):
    return [
        np.array(line.get_data()).T
        for line in axes.get_lines()
        if line.get_label() == label
    ]


def test_a_block_has_its_pivots_mass_centre_and_alpha(structures_drawn):
    (axes,) = structures_drawn("block")
    assert axes.get_aspect() == 1.0
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("$x$ [m]", "$z$ [m]")
    body, moved = (patch.get_xy()[:4] for patch in axes.patches)
    assert body == pytest.approx(
        np.array([(-0.25, 0), (0.25, 0), (0.25, 2), (-0.25, 2)]), abs=1e-14
    )
    assert moved[1] == pytest.approx((0.25, 0), abs=1e-14)
    assert [
        labelled(axes, f"_pivot {side}")[0].tolist() for side in ("left", "right")
    ] == [[[-0.25, 0]], [[0.25, 0]]]
    assert labelled(axes, "_mass centre")[0] == pytest.approx(
        np.array([[0, 1]]), abs=1e-14
    )
    (arc,) = labelled(axes, "_alpha")
    ends = np.arctan2(arc[[0, -1], 0] - 0.25, arc[[0, -1], 1])
    assert ends == pytest.approx([0, -math.atan(0.25)], abs=1e-12)
    assert (
        axes.get_title()
        == "Column\n$p$ = 2.672 rad/s, $\\alpha$ = 14.04°\n$\\eta$ = 0.912, $\\lambda$"
        " = 0.25, $R$ = 1.03 m"
    )


def test_hinges_are_numbered_and_a_crack_is_named(structures_drawn):
    arch, spire = structures_drawn("arch", "spire_cracked")
    texts = [text.get_text() for text in arch.texts]
    assert [text for text in texts if text.isdigit()] == ["1", "2", "3", "4"]
    assert len(arch.patches) == 14  # seven voussoirs, and the same displaced
    assert "$a_{scale}$ = 0.1867" in arch.get_title()
    (crack,) = labelled(spire, "crack")
    assert crack == pytest.approx(np.array([(1.5, 0), (-0.15, 10.8)]), abs=1e-12)
    assert "crack" in [text.get_text() for text in spire.texts]


def test_what_leans_the_other_way_has_alpha_on_its_left(
    structures_drawn, tmp_path, pytestconfig
):
    (tmp_path / "left.yaml").write_text(
        "kind: rigid\nleft: 0.2\nright: 0.3\nheight: 1\ngyration: 0.6\n"
    )
    (axes,) = structures_drawn(tmp_path / "left")
    (arc,) = labelled(axes, "_alpha")
    ends = np.arctan2(arc[[0, -1], 0] + 0.2, arc[[0, -1], 1])
    assert ends == pytest.approx([0, math.atan(0.2)], abs=1e-12)


def test_lengths_and_angles_are_in_the_units_asked_for(structures_drawn):
    (axes,) = structures_drawn("block", units=parse_units("cm,rad"))
    assert axes.get_xlabel() == "$x$ [cm]"
    assert axes.patches[0].get_xy()[2] == pytest.approx((25, 200), rel=1e-14)
    assert "$\\alpha$ = 0.245 rad" in axes.get_title()


def test_a_one_sided_body_has_its_backing_on_the_left(structures_drawn):
    (axes,) = structures_drawn("wall")
    (backing,) = [patch for patch in axes.patches if patch.get_hatch()]
    assert backing.get_xy()[:, 0].max() == pytest.approx(-0.6)


def test_a_dollar_in_a_name_is_a_dollar(structures_drawn, tmp_path):
    (tmp_path / "dollar.yaml").write_text(
        'kind: block\nname: "a $ b $ c"\nwidth: 1\nheight: 5\n'
    )
    (axes,) = structures_drawn(tmp_path / "dollar")
    assert axes.get_title().startswith("a \\$ b \\$ c\n")


def test_bodies_are_at_one_scale_and_one_without_geometry_is_left_out(structures_drawn):
    remarks = []
    axes = structures_drawn("block", "parameters", "rigid", tell=remarks.append)
    assert [one.get_title().partition("\n")[0] for one in axes] == ["Column", "Statue"]
    assert {"0.5 m", "2 m"} <= {text.get_text() for text in axes[0].texts}
    circle = axes[1].patches[0]
    assert (circle.get_label(), circle.get_facecolor()[3]) == ("_gyration", 0.0)
    assert {"mass centre", "radius of gyration"} <= {
        t.get_text() for t in axes[1].texts
    }
    assert (
        len(
            {
                (np.diff(one.get_xlim()).item(), np.diff(one.get_ylim()).item())
                for one in axes
            }
        )
        == 1
    )
    assert [said.endswith("left out") for said in remarks] == [True]
    with pytest.raises(DocumentError, match="states no geometry"):
        structures_drawn("parameters")


def test_bodies_of_unequal_size_have_their_own_scales_and_one_bar(structures_drawn):
    for axes in structures_drawn("block", "arch"):
        (bar,) = labelled(axes, "_scale")
        assert np.ptp(bar[:, 0]) == pytest.approx(0.5, rel=1e-12)
        assert "0.5 m" in [text.get_text() for text in axes.texts]


def test_a_long_name_stands_on_lines_of_its_panel(figures, tmp_path):
    name = (
        "Marble lion with a very long inventory name 1884.12.3 of the east staircase"
        " landing"
    )
    draw_structures(
        parse_documents(f"{{kind: block, name: {name}, width: 0.7, height: 0.95}}"),
        tmp_path / "figure.png",
    )
    (axes,) = figures[-1].axes
    *lines, _, _ = axes.get_title().splitlines()
    assert (" ".join(lines), max(map(len, lines)) <= 48) == (name, True)


@pytest.mark.parametrize(
    ("name", "labels"), [("wall_between_floors", ["held"]), ("wall_tied", ["tie"])]
)
def test_the_name_of_a_line_stands_beside_the_body_with_a_line_to_it(
    structures_drawn, name, labels
):
    (axes,) = structures_drawn(name)
    bodies = [p for p in axes.patches if p.get_label() in ("_rocks", "_moved")]
    right = max(corner for body in bodies for corner in body.get_xy()[:, 0])
    beside = [text for text in axes.texts if text.get_text() in labels]
    assert len(beside) == len(labels)
    for text in beside:
        assert right < text.get_position()[0] < axes.get_xlim()[1]
        assert text.arrow_patch is not None


def test_names_keep_their_distance_and_a_crack_needs_no_line(structures_drawn):
    assert spaced([0.0, 0.1, 0.1, 1.0], 0.25) == [0.0, 0.25, 0.5, 1.0]
    (axes,) = structures_drawn("spire_cracked")
    (crack,) = [text for text in axes.texts if text.get_text() == "crack"]
    assert (crack.xy, crack.arrow_patch) == (pytest.approx((-0.15, 10.8)), None)


def test_a_label_leaves_the_lines_beside_its_point():
    corner = Ink([], [[(0, 0), (0, 9)], [(0, 0), (9, 0)]])
    assert corner.clearance((3.0, 4.0)) == 3.0
    x, z = corner.clearest((0, 0), 1.0, 0.5 * math.pi)
    assert (abs(x), z) == pytest.approx((math.sqrt(0.5), math.sqrt(0.5)))
    narrow = Ink(
        [], [[(0.5, -9), (0.5, 9)], [(-0.5, -9), (-0.5, 9)], [(-9, 0), (9, 0)]]
    )
    assert abs(narrow.clearest((0, 0), 1.0, 0.0)[0]) > 1.0  # beyond both walls
    assert Ink([[(0, 0), (2, 0), (2, 2), (0, 2)]]).covers((1.0, 1.5))


def test_a_portal_on_a_slope_stands_on_the_ground_with_both_feet(structures_drawn):
    (axes,) = structures_drawn("mechanism_portal")
    (ground,) = labelled(axes, "_ground")
    feet = ground[1:-1]
    expected = [(0.0, 0.0), (0.7, 0.0), (3.0, -0.6), (3.6, -0.6)]
    assert feet == pytest.approx(np.array(expected), abs=1e-12)
    for name in ("block", "arch"):
        (level,) = structures_drawn(name)
        assert labelled(level, "_ground") == []


def test_a_flat_body_in_front_does_not_flatten_the_others(structures_drawn):
    axes = structures_drawn("arch", "wall")
    width, height = axes[0].figure.get_size_inches()
    assert height > 0.7 * width  # two panels across


def test_a_narrow_figure_of_several_panels_has_small_texts(structures_drawn):
    figure = structures_drawn("block", "wall", "arch", look=Look(width=0.16))[0].figure
    assert figure.get_size_inches()[0] == pytest.approx(0.16 / 0.0254)
    (one,) = structures_drawn("block", look=Look(width=0.16))
    sizes = [axes.title.get_size() for axes in (figure.axes[0], one)]
    assert sizes[0] == pytest.approx(0.6 * sizes[1])
