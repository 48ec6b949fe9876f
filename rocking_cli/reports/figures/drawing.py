"""Drawings of structures to scale: bodies at rest and at alpha, pivots or numbered
hinges, mass centre, alpha, and cracks.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from textwrap import fill
from typing import Any

from ...errors import DocumentError, UsageError
from ...structures.given import Structure, structures_from
from ...structures.kinds import sketch_of
from ...structures.parameters import RockingParameters, weaker_side
from ...structures.sketch import Dimension, Point, Sketch, rectangle
from ..units import Units
from .canvas import (
    Axes,
    Look,
    canvas,
    literal,
    panels,
    panels_across,
    require_axes,
)
from .labels import Ink, spaced

_WIDTH = 4.2  # inches, of a panel
_LETTER = 0.028  # width of a small letter over the size of the drawing
_NEAR = 1e-9  # distance of points that coincide over the size of the drawing
_BESIDE = 0.05  # distance of a label from its point over the size of the drawing
_ALIKE = 2.5  # ratio of the sizes of bodies that are drawn at one scale
STONE, GROUND, INK, ACCENT = "#D9CBB8", "#EFEFEF", "#333333", "#D55E00"


def draw_structures(
    structures: Structure | Sequence[Structure],
    target: str | Path | Axes,
    *,
    units: Units | None = None,
    look: Look | None = None,
    overwrite: bool = True,
    tell: Callable[[str], None] | None = None,
) -> Axes | None:
    """Draw structures to scale, each in its own panel of a PNG, SVG or PDF file, or one
    into Axes.

    Parameters
    ----------
    structures
        one or more: parameters, documents, paths, or texts such as "block:0.5x2"; one
        without geometry is left out
    target
        the file to write, or Axes of matplotlib for one structure
    units
        of the lengths, None for those of the figure
    look
        size, title and style, None for the figure's own
    overwrite
        False: an existing file is an error
    tell
        called with a sentence on a structure that is left out, and on characters that
        the font lacks

    Returns
    -------
    Axes or None
        the Axes if the target is one

    Raises
    ------
    UsageError
        for another kind of file, one that exists, or Axes for several structures
    DocumentError
        if a document is not valid or no structure has a geometry
    OutputError
        when the file cannot be written or matplotlib is not installed

    Examples
    --------
    >>> draw_structures(read_documents("configs/arch.yaml"), "arch.svg")
    """
    found = _sketched(structures_from(structures), tell)
    if not isinstance(target, str | Path):
        if len(found) > 1:
            raise UsageError(
                f"found {len(found)} structures; expected one, or a file as target"
            )
        structure_axes(require_axes(target), *found[0], units or Units())
        return target
    across = panels_across(len(found))
    look = replace(look or Look(), natural=_WIDTH * across)
    with canvas(target, overwrite, look=look, tell=tell) as figure:
        drawn = panels(figure, len(found))
        units = units or Units()
        sizes = [_size(sketch) for _, sketch in found]
        one_scale = max(sizes) <= _ALIKE * min(sizes)
        for axes, (one, sketch) in zip(drawn, found, strict=True):
            if one_scale and axes is not drawn[0]:
                axes.sharex(drawn[0])
                axes.sharey(drawn[0])
            structure_axes(axes, one, sketch, units)
            if not one_scale:
                _plot_scale_bar(axes, 0.4 * min(sizes), units)
        figure.supxlabel("dashed: at the critical rotation", fontsize="x-small")
        shape = min(1.4, max(0.4, *map(_shape, drawn)))
        figure.set_size_inches(
            _WIDTH * across, -(-len(found) // across) * (1.0 + (_WIDTH - 0.6) * shape)
        )
    return None


def _sketched(
    structures: Sequence[RockingParameters], tell: Callable[[str], None] | None
) -> list[tuple[RockingParameters, Sketch]]:
    """Return the structures that have a geometry, with their sketches. Raises
    DocumentError if none has.
    """
    found: list[tuple[RockingParameters, Sketch]] = []
    for one in structures:
        try:
            if one.document is None:
                raise DocumentError(
                    f"{one.name}: found numbers alone; expected a document with a"
                    " geometry"
                )
            found.append((one, sketch_of(one.document, one)))
        except DocumentError as error:
            if one is structures[-1] and not found:
                raise
            if tell is not None:
                tell(f"{error}; left out")
    return found


def structure_axes(
    axes: Axes,
    built: RockingParameters,
    sketch: Sketch,
    units: Units,
    described: bool = True,
) -> None:
    """Draw one structure; described: True for its name and parameters as the title, of
    which False leaves R alone.
    """
    unit, metre = units.of("length")
    sketch = sketch.in_unit(metre)
    ground = _ground(sketch)
    ink = _ink_of(sketch).with_lines(ground)
    _fill_outlines(axes, sketch)
    named = _plot_lines(axes, sketch)
    named += _draw_arrows(axes, sketch, ink)
    _mark_pivots(axes, sketch, ink)
    base = min(z for _, z in ground)
    _plot_ground(axes, ground)
    if built.one_sided:
        _hatch_backing(axes, sketch, base)
    _plot_dimensions(axes, sketch, base, unit)
    radius = ""
    # under a load that it does not carry a body turns by another angle than that of R
    if sketch.centre is not None and built.mechanism is None:
        length = _mass_centre(axes, built, sketch, ink)
        radius = f"$R$ = {length:.3g} {unit}"
    if named:
        _name_lines(axes, named, ink)
    axes.set_aspect("equal")
    axes.margins(0.1)
    axes.grid(visible=False)
    axes.set(xlabel=f"$x$ [{unit}]", ylabel=f"$z$ [{unit}]")
    title = radius
    if described:
        numbers = ", ".join(filter(None, (_numbers(built, units), radius)))
        title = f"{fill(literal(built.name), 48)}\n{numbers}"
    axes.set_title(title, fontsize="small")


# Style of each group of outlines of a sketch, in the order in which they are drawn.
_STYLES: dict[str, dict[str, Any]] = {
    "still": {"facecolor": GROUND, "edgecolor": "0.6", "lw": 0.8, "label": "_stays"},
    "bodies": {"facecolor": STONE, "edgecolor": INK, "lw": 0.9, "label": "_rocks"},
    "hollows": {
        "facecolor": "none",
        "edgecolor": "0.45",
        "lw": 0.7,
        "ls": (0, (4, 3)),
        "label": "_hollow",
    },
    "moved": {
        "facecolor": "none",
        "edgecolor": "#0072B2",
        "lw": 0.9,
        "ls": "--",
        "label": "_moved",
    },
}


def _fill_outlines(axes: Axes, sketch: Sketch) -> None:
    """Draw the parts that stay, the bodies at rest and at alpha, and cavities."""
    for group, style in _STYLES.items():
        outlines = getattr(sketch, group)
        if sketch.gyration and group in ("bodies", "moved"):
            circle, *outlines = outlines
            if group == "bodies":
                _plot_gyration(axes, circle)
        for outline in outlines:
            x, z = zip(*outline, strict=True)
            if len(x) > 2:
                axes.fill(x, z, **style)
                continue
            # a line: an outline would run along it and back, and fill its gaps
            keys = ("lw", "ls", "label")
            line = {key: style[key] for key in keys if key in style}
            axes.plot(x, z, color=style["edgecolor"], **line)


def _plot_gyration(axes: Axes, circle: Sequence[Point]) -> None:
    """Draw the circle of the radius of gyration, which is no outline of the body."""
    style: dict[str, Any] = {
        "facecolor": "none",
        "edgecolor": "0.45",
        "lw": 0.9,
        "ls": "--",
    }
    axes.fill(*zip(*circle, strict=True), **style, label="_gyration")
    axes.annotate(
        "radius of gyration",
        max(circle, key=lambda point: point[1]),
        xytext=(0, 3),
        textcoords="offset points",
        ha="center",
        color="0.35",
        fontsize="x-small",
    )


def _size(sketch: Sketch) -> float:
    """Return the larger of width and height of the drawing."""
    outlines = (*sketch.bodies, *sketch.still, *sketch.moved)
    xs, zs = zip(*(point for outline in outlines for point in outline), strict=True)
    return max(max(xs) - min(xs), max(zs) - min(zs))


def _shape(axes: Axes) -> float:
    """Return the height of the axes over their width, in their units."""
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    return (high - low) / (right - left)


def _plot_scale_bar(axes: Axes, most: float, units: Units) -> None:
    """Draw a bar whose length is a round number below `most` [m] on the right below
    the ground.
    """
    unit, metre = units.of("length")
    decade = 10.0 ** math.floor(math.log10(most / metre))
    length = decade * max(step for step in (1, 2, 5) if step * decade <= most / metre)
    low, right = axes.get_ylim()[0], axes.get_xlim()[1]
    axes.plot([right - length, right], [low, low], color=INK, lw=3.0, label="_scale")
    axes.annotate(
        f"{length:g} {unit}",
        (right - length, low),
        xytext=(-4, 0),
        textcoords="offset points",
        ha="right",
        va="center",
        fontsize="small",
    )


def _plot_dimensions(axes: Axes, sketch: Sketch, base: float, unit: str) -> None:
    """Draw the lines of the dimensions, and the remark of a sketch; base: z below which
    those of horizontal lengths stand.
    """
    edge = axes.dataLim.x0
    away = 0.06 * max(axes.dataLim.width, axes.dataLim.height)
    for one in sketch.dimensions or _foot_and_height(sketch):
        (x0, z0), (x1, z1) = one.start, one.end
        upright = x0 == x1
        if one.beside and upright:
            x0 = x1 = edge - away
        elif one.beside:
            z0 = z1 = base - away
        length = f"{math.hypot(x1 - x0, z1 - z0):.3g} {unit}"
        turn = 90.0 * (upright and one.beside)
        _plot_dimension(axes, (x0, z0), (x1, z1), length, turn, inside=not one.beside)
    if sketch.remark:
        middle = axes.dataLim.x0 + 0.5 * axes.dataLim.width
        axes.annotate(
            sketch.remark,
            (middle, base - away),
            ha="center",
            va="top",
            color="0.3",
            fontsize="x-small",
        )
    axes.update_datalim([(edge - 2.5 * away, base - 2.0 * away)])


def _foot_and_height(sketch: Sketch) -> list[Dimension]:
    """Return the width at the foot and the height of a body; of one that is known by
    its mass centre those of the edges and the centre.
    """
    points = [point for outline in sketch.bodies for point in outline]
    foot, top = (end(z for _, z in points) for end in (min, max))
    feet = [x for x, z in points if abs(z - foot) < 1e-9]
    if sketch.gyration and sketch.centre is not None:
        top = sketch.centre[1]
    height = Dimension((0.0, foot), (0.0, top))
    if len(feet) < 2:
        return [height]
    return [Dimension((min(feet), foot), (max(feet), foot)), height]


def _plot_dimension(
    axes: Axes,
    start: Point,
    end: Point,
    text: str,
    rotation: float = 0.0,
    *,
    inside: bool = False,
) -> None:
    """Draw a line with an arrow at both ends and its length beside it; inside: the
    length stands below the line, as beside it there is no room.
    """
    arrow = {"arrowstyle": "<->", "lw": 0.6, "color": "0.4", "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", start, end, arrowprops=arrow)
    axes.annotate(
        text,
        start if inside else (0.5 * (start[0] + end[0]), 0.5 * (start[1] + end[1])),
        xytext=(-4, 0) if rotation else (0, -4),
        textcoords="offset points",
        ha="right" if rotation else "center",
        va="center" if rotation else "top",
        rotation=rotation,
        color="0.3",
        fontsize="x-small",
    )


def _ground(sketch: Sketch) -> list[Point]:
    """Return the ground below a sketch, from left to right: level, or through the feet
    of the bodies that stand on it at several heights.
    """
    whole = (*sketch.bodies, *sketch.still)
    size = _size(sketch)
    base = min(z for outline in whole for _, z in outline)
    found = _feet(whole, [point for _, point in sketch.pivots], _NEAR * size)
    if all(z - base < _NEAR * size for _, z in found):
        found = sorted((x, base) for outline in whole for x, _ in outline)
    (first, left), (last, right) = found[0], found[-1]
    return [(first - size, left), *found, (last + size, right)]


def _feet(
    whole: Sequence[Sequence[Point]], pivots: Sequence[Point], near: float
) -> list[Point]:
    """Return the ends of the level feet of the bodies that stand on the ground, from
    left to right; near: the largest distance of points that coincide.
    """
    inks = [Ink([outline]) for outline in whole]
    # a hinge on the outline of one body alone is one with the ground
    grounded = [
        point
        for point in pivots
        if sum(one.clearance(point) < near for one in inks) == 1
    ]
    feet: list[list[Point]] = []
    for outline in whole:
        low = min(z for _, z in outline)
        foot = sorted(point for point in outline if point[1] - low < near)
        if len(foot) > 1 and any(
            Ink([], [foot]).clearance(point) < near for point in grounded
        ):
            feet.append([foot[0], foot[-1]])
    return [point for foot in sorted(feet) for point in foot]


def _plot_ground(axes: Axes, ground: Sequence[Point]) -> None:
    """Draw the ground, over the whole width of the axes."""
    levels = {z for _, z in ground}
    if len(levels) == 1:
        axes.axhline(levels.pop(), color=INK, lw=1.2, zorder=0.5)
        return
    from matplotlib.lines import Line2D

    # an artist has no part in the limits of the axes
    x, z = zip(*ground, strict=True)
    axes.add_artist(Line2D(x, z, color=INK, lw=1.2, zorder=0.5, label="_ground"))


def _ink_of(sketch: Sketch) -> Ink:
    """Return the outlines and lines of a sketch."""
    outlines = (*sketch.bodies, *sketch.still, *sketch.moved, *sketch.hollows)
    lines = [course for _, course in (*sketch.lines, *sketch.arrows)]
    return Ink(outlines, lines)


def _plot_lines(axes: Axes, sketch: Sketch) -> list[tuple[str, Point]]:
    """Draw other lines, such as cracks; return the name and the upper end of the first
    of each name.
    """
    named: dict[str, Point] = {}
    for label, course in sketch.lines:
        image = label.startswith("its ")  # of a line before
        axes.plot(
            *zip(*course, strict=True),
            color=ACCENT,
            lw=0.8 if image else 1.6,
            ls=":" if image else "-",
            label=label,
        )
        if not image and not label.startswith("_"):
            named.setdefault(label, max(course, key=lambda point: point[::-1]))
    return list(named.items())


def _draw_arrows(axes: Axes, sketch: Sketch, ink: Ink) -> list[tuple[str, Point]]:
    """Draw the arrows, such as loads, each with its text at the tail; return the texts
    and tails of those whose tail lies on a body.
    """
    covered = []
    for label, (tail, head) in sketch.arrows:
        axes.plot(*zip(tail, head, strict=True), color=ACCENT, lw=1.6, label=label)
        axes.annotate(
            "",
            head,
            xytext=tail,
            arrowprops={"arrowstyle": "-|>", "color": ACCENT, "shrinkB": 0.0},
        )
        if ink.covers(tail):
            covered.append((label, tail))
            continue
        axes.annotate(
            label,
            tail,
            xytext=(4, 2),
            textcoords="offset points",
            color=ACCENT,
            fontsize="small",
        )
    return covered


def _name_lines(axes: Axes, named: Sequence[tuple[str, Point]], ink: Ink) -> None:
    """Write each name on the left of its point where it is clear of the drawing, else
    on the right of the drawing with a line to the point.
    """
    size = max(axes.dataLim.width, axes.dataLim.height)
    beside = []
    for name, point in named:
        if not ink.free_on_left(point, _LETTER * size * len(name)):
            beside.append((name, point))
            continue
        axes.annotate(
            name,
            point,
            xytext=(-4, 6),
            textcoords="offset points",
            ha="right",
            color=ACCENT,
            fontsize="small",
        )
    beside.sort(key=lambda one: one[1][1])
    right = axes.dataLim.x1 + 0.05 * size
    heights = spaced([z for _, (_, z) in beside], 0.05 * size)
    for (name, point), height in zip(beside, heights, strict=True):
        axes.annotate(
            name,
            point,
            xytext=(right, height),
            va="center",
            color=ACCENT,
            fontsize="small",
            arrowprops={"arrowstyle": "-", "lw": 0.6, "color": ACCENT, "shrinkB": 0},
        )
        axes.update_datalim([(right + _LETTER * size * len(name), height)])


def _mark_pivots(axes: Axes, sketch: Sketch, ink: Ink) -> None:
    """Draw the pivots, and the numbers of hinges."""
    away = _BESIDE * _size(sketch)
    for name, (x, z) in sketch.pivots:
        axes.plot(x, z, "o", color=ACCENT, ms=4.5, label=f"_pivot {name}")
        if name.isdigit():
            place = ink.clearest((x, z), away, math.pi / 4)
            axes.update_datalim([place])
            axes.annotate(
                name,
                place,
                ha="center",
                va="center",
                color=ACCENT,
                fontweight="bold",
            )


def _hatch_backing(axes: Axes, sketch: Sketch, base: float) -> None:
    """Draw the backing of a one-sided body, on its left; base: z of its foot."""
    left = min(x for outline in sketch.bodies for x, _ in outline)
    top = max(z for outline in sketch.bodies for _, z in outline)
    wall = rectangle(left - 0.15 * top, left, base, top)
    axes.fill(
        *zip(*wall, strict=True),
        facecolor="none",
        edgecolor="0.5",
        hatch="///",
        lw=0.0,
        label="_backing",
    )


def _mass_centre(
    axes: Axes, built: RockingParameters, sketch: Sketch, ink: Ink
) -> float:
    """Draw the mass centre, and R and alpha at the weaker edge, or the right one;
    return R.
    """
    assert sketch.centre is not None
    side = weaker_side(built.sides).side if built.sides else "right"
    (px, pz), (cx, cz) = dict(sketch.pivots)[side], sketch.centre
    axes.plot(cx, cz, "P", color="k", ms=7, mec="w", mew=0.8, label="_mass centre")
    if sketch.gyration:
        axes.annotate(
            "mass centre",
            (cx, cz),
            xytext=(6, 4),
            textcoords="offset points",
            color="0.35",
            fontsize="x-small",
        )
    axes.plot([px, cx], [pz, cz], color=INK, lw=0.9, label="_R")
    axes.plot([px, px], [pz, cz], color=INK, lw=0.9, ls=":", label="_vertical")
    return _arc_of_alpha(axes, (px, pz), (cx, cz), _size(sketch), ink)


def _arc_of_alpha(
    axes: Axes,
    pivot: Point,
    centre: Point,
    size: float,
    ink: Ink,
) -> float:
    """Draw alpha between the vertical at a pivot and the mass centre; return R. size:
    that of the structure.
    """
    (px, pz), (cx, cz) = pivot, centre
    # alpha is signed: negative towards the left
    radius = math.hypot(cx - px, cz - pz)
    alpha = math.atan2(cx - px, cz - pz)
    reach = 0.55 * radius
    angles = [alpha * i / 24 for i in range(25)]
    arc = [(px + reach * math.sin(a), pz + reach * math.cos(a)) for a in angles]
    axes.plot(*zip(*arc, strict=True), color=INK, lw=0.9, label="_alpha")
    outwards = 0.0 if alpha < 0.0 else math.pi
    ink = ink.with_lines([(cx, cz), (px, pz), (px, cz)], arc)
    place = ink.clearest((px, pz + reach), _BESIDE * size, outwards)
    axes.update_datalim([place])
    axes.annotate(r"$\alpha$", place, ha="center", va="center")
    return radius


def _numbers(built: RockingParameters, units: Units) -> str:
    """Return the parameters of a structure in two lines."""
    name, radian = (
        units.of("angle") if "angle" in units.chosen else ("deg", math.pi / 180.0)
    )
    angle = f"{built.alpha / radian:.4g}{'°' if name == 'deg' else f' {name}'}"
    scale = f", $a_{{scale}}$ = {built.a_scale:.4g}" if built.a_scale != 1.0 else ""
    return (
        f"$p$ = {built.p:.4g} rad/s, $\\alpha$ = {angle}\n$\\eta$ = {built.eta:.3g},"
        f" $\\lambda$ = {built.uplift:.4g}{scale}"
    )
