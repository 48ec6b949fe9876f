"""Functions that all figures share: style, colours, labels, panels, legends and the
output file. matplotlib is imported by what draws.

The colours of Okabe and Ito are distinct for colour-blind readers; lines also differ in
dash.
"""

import io
import re
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING, Any
from weakref import WeakSet

import numpy as np

from ...documents.files import whole_text
from ...errors import ArgumentError, OutputError, UsageError
from ...plugins import require
from ...publishing import check_target, published
from ...structures.parameters import RockingParameters
from ..rows import Rows, column, groups
from ..units import Units, parse_units

if TYPE_CHECKING:
    from matplotlib.axes import Axes as Axes
    from matplotlib.figure import Figure as Figure
else:  # the names alone: matplotlib is loaded by what draws
    Axes = Figure = Any

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#000000")
DASHES = ("-", "--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)))
MARKERS = "osv^D"
STYLE: dict[Any, Any] = {
    "font.size": 9,
    "axes.grid": True,
    "grid.alpha": 0.3,
    "grid.linewidth": 0.5,
    "axes.axisbelow": True,
    "axes.titlesize": "medium",
    "legend.fontsize": "small",
    "legend.framealpha": 0.9,
    "figure.dpi": 200,
    "figure.constrained_layout.use": True,
    "svg.hashsalt": "rocking",
    "svg.fonttype": "none",
    "pdf.fonttype": 42,
    "axes.prop_cycle": f"cycler('color', {list(COLOURS)})",
}
WIDTH, PANEL = 5.6, (4.2, 3.2)  # inches
_INCH = 0.0254  # m
_POINTS = 72.0  # an inch: the unit of an SVG or PDF
MOST_ACROSS, MOST_PANELS = 3, 24
_MOST_BELOW = 9  # entries of a legend below the figure
# equal figures give equal files
_UNDATED: dict[str, dict[str, Any]] = {
    "svg": {"Date": None},
    "pdf": {"CreationDate": None},
}
_NO_LAYOUT: dict[Any, Any] = {
    "figure.constrained_layout.use": False,
    "figure.autolayout": False,
}
_TITLE = 72  # characters of a line of a title
_CYCLES = re.compile(r"(.+?) ([\d.]+) cycles?(.*)")  # the name of a sine or cosine
_COUNTS = {"1": "one cycle of", "0.5": "half a cycle of"}
_NO_GLYPH = r"Glyph (\d+) "  # the beginning of a warning of matplotlib
FIGURE_UNITS = parse_units("g,Hz")  # the default
SYMBOLS = {
    "A": r"$A = a_{scale}\,a_g/(\alpha g)$",
    "Omega": r"$\Omega = \omega_g/p$",
    "a_g": r"$a_g$",
    "omega_g": r"$\omega_g$",
    "f_g": r"$f_g$",
    "t": "time $t$",
    "tau": r"$p\,t$",
    "theta": r"rotation $\theta$",
    "theta_ratio": r"$\theta/\alpha$",
    "theta_max_ratio": r"$\theta_{max}/\alpha$",
    "ground_acceleration": r"$\ddot{x}_g$",
    "slide": "slide $u$",
    "slide_velocity": r"$\dot{u}$",
    "A_s": r"$A\,s$",
    "p": "$p$",
    "alpha": r"$\alpha$",
    "eta": r"$\eta$",
    "lambda": r"$\lambda$",
    "a_scale": r"$a_{scale}$",
    "T": r"$T = 2\pi/p$",
    "scale": "factor of the record",
    "pga": "PGA",
    "pgv_pga": "PGV/PGA",
}
SOURCE = "file"  # a column that names the file of each row, where several are drawn
_OWN: WeakSet[Any] = WeakSet()  # the figures of `styled`
DRAWN_WITH = ("figures need", "matplotlib")  # the arguments of `require`
PLAIN = {"m/s2": "m/s²", "cm/s2": "cm/s²"}


@dataclass(frozen=True)
class Look:
    """The look of a figure file; None leaves a choice to the figure.

    `draw` and the other drawing functions take one.

    Attributes
    ----------
    width: [m]
    dpi: dots per inch
    title: text above the figure
    style: a style file of matplotlib
    natural: width of the figure without a choice [inches], for which its texts are made

    Examples
    --------
    >>> _ = draw_structures(
    ...     read_documents("configs/block.yaml"), "b.svg", look=Look(width=0.08)
    ... )
    >>> Look(width=0.08, title="Column").title
    'Column'
    """

    width: float | None = None  # [m]
    dpi: float | None = None  # dots per inch
    title: str | None = None  # text above the figure
    style: str | Path | None = None  # a style file of matplotlib
    natural: float = WIDTH  # of the figure without a choice [inches], for its texts

    def finish(self, figure: Figure) -> None:
        """Give a figure its title, that of the only panel or above all, and its size.

        Parameters
        ----------
        figure
            a Figure of matplotlib
        """
        if self.title is not None and len(figure.axes) == 1:
            figure.axes[0].title.set_text(literal(self.title))
        elif self.title is not None:
            figure.suptitle(literal(self.title))
        if self.width is not None:
            width, height = figure.get_size_inches()
            share = max(self.text_share(), self.width / _INCH / width)
            figure.set_size_inches(self.width / _INCH, height * share)

    def text_share(self) -> float:
        """Return the factor of the text size in a figure that is wide by itself.

        Returns
        -------
        float
            0.6 to 1
        """
        if self.width is None:
            return 1.0
        return min(1.0, max(0.6, self.width / _INCH / self.natural))


def is_own(axes: Axes) -> bool:
    """True for Axes of a figure that `styled` makes, False for those of the caller,
    around which there is no room.
    """
    return axes.figure in _OWN


def fit_title(axes: Axes) -> None:
    """Break the title of Axes of the caller into lines that are as wide as the Axes."""
    figure: Any = axes.figure
    wide = axes.get_position().width * figure.get_size_inches()[0] * _POINTS
    room = max(int(wide / (0.55 * float(axes.title.get_fontsize()))), 12)
    lines = axes.get_title().splitlines()
    axes.set_title("\n".join(fill(line, room) for line in lines), fontsize="small")


def require_axes(target: Any) -> Axes:
    """Return Axes of matplotlib. Raises ArgumentError for another target."""
    if not all(hasattr(target, name) for name in ("plot", "get_xlim", "figure")):
        raise ArgumentError(
            f"`target`: found a {type(target).__name__}; expected a path (a text or a"
            " Path) or Axes of matplotlib"
        )
    return target


@contextmanager
def styled(look: Look) -> Iterator[Figure]:
    """Context of an empty figure in the common style. Raises OutputError without
    matplotlib, and UsageError if the style file cannot be read.
    """
    require(*DRAWN_WITH)
    import matplotlib as mpl
    from matplotlib.figure import Figure

    with mpl.rc_context(STYLE):
        if look.style is not None:
            try:
                mpl.rc_file(look.style, use_default_template=False)
            except (OSError, UnicodeDecodeError) as error:
                raise UsageError(
                    f"{look.style}: cannot be read as a style of matplotlib: {error}"
                ) from None
        mpl.rcParams["font.size"] *= look.text_share()
        figure = Figure(figsize=(WIDTH, 4.0))
        _OWN.add(figure)
        yield figure


@contextmanager
def canvas(
    target: str | Path,
    overwrite: bool = True,
    *,
    look: Look | None = None,
    tell: Callable[[str], None] | None = None,
) -> Iterator[Figure]:
    """Context of a `styled` figure, written to `target` at its end; tell: called with
    the characters that the font lacks. Raises UsageError for a target that cannot or
    must not be written, before anything is drawn, and OutputError.
    """
    target, look = Path(target), look or Look()
    check_target(target, overwrite)
    with styled(look) as figure:
        _require_format(figure, target)
        yield figure
        drawn, missing = drawn_as(figure, target, look)
    if missing and tell is not None:
        tell(f"{target}: the font of the figure has no {missing}; boxes stand there")
    with published(target, overwrite) as file:
        file.write(drawn)


def _require_format(figure: Figure, target: Path) -> None:
    """Raise UsageError if matplotlib writes no figure with this suffix."""
    known = figure.canvas.get_supported_filetypes()
    if target.suffix[1:].lower() not in known:
        raise UsageError(
            f"{target}: expected a name that ends in"
            f" {', '.join(f'.{form}' for form in known)}"
        )


def drawn_as(figure: Figure, target: Path, look: Look) -> tuple[bytes, str]:
    """Return (the figure in the format of `target`, the characters that its font
    lacks). Raises OutputError.
    """
    look.finish(figure)
    form, drawn = target.suffix[1:].lower(), io.BytesIO()
    # that of a map inside an SVG or PDF
    dpi = look.dpi or (600 if form in _UNDATED else figure.dpi)
    with warnings.catch_warnings(record=True) as raised:
        warnings.filterwarnings("always", message=_NO_GLYPH)
        try:
            _arrange(figure, form, dpi)
            figure.savefig(drawn, format=form, dpi=dpi, metadata=_UNDATED.get(form))
        except (OSError, ValueError) as error:
            raise OutputError(f"{target}: cannot be drawn: {error}") from None
    missing = {
        chr(int(found[1]))
        for w in raised
        if (found := re.match(_NO_GLYPH, str(w.message)))
    }
    return drawn.getvalue(), " ".join(sorted(missing))


def _arrange(figure: Figure, form: str, dpi: float) -> None:
    """Let the layout place the axes as a file of this format has them; `savefig` would
    draw the whole figure for it, and then again.
    """
    import matplotlib as mpl
    from matplotlib.backend_bases import get_registered_canvas_class

    engine = figure.get_layout_engine()
    if engine is None:
        return
    get_registered_canvas_class(form)(figure)  # its renderer measures the texts
    figure.dpi = _POINTS if form in _UNDATED else dpi
    engine.execute(figure)
    with mpl.rc_context(_NO_LAYOUT):
        figure.set_layout_engine(None)


def literal(text: str) -> str:
    """Return the text as a font can draw it, with its dollar signs escaped: it has no
    formula.
    """
    return whole_text(text).replace("$", r"\$")


def label(column: str, units: Units) -> str:
    """Return the axis label of a column in these units, such as `$a_g$ [m/s²]`."""
    name, unit, _ = units.column(column)
    return (
        f"{SYMBOLS.get(name, name.replace('_', ' '))} [{PLAIN.get(unit, unit) or '-'}]"
    )


def valued(column: str, value: float, units: Units) -> str:
    """Return a column and its value (SI) as text, such as `$f_g$ = 1.5 Hz`."""
    name, unit, factor = units.column(column)
    short = {"A": "$A$", "Omega": r"$\Omega$", "T": "$T$"}.get(name) or SYMBOLS.get(
        name, name
    )
    return f"{short} = {value / factor:.4g} {PLAIN.get(unit, unit)}".rstrip()


def titled(structure: RockingParameters) -> str:
    """Return the name of a structure and its eta; only eta if the name already states
    it, as for a dimensionless oscillator.
    """
    words = rf"$\eta$ = {structure.eta:.4g}"
    if structure.name == f"eta={structure.eta:g}":
        return words
    return f"{literal(structure.name)}, {words}"


def heading(rows: Rows, units: Units, *keys: str) -> str:
    """Return the texts that are the same in all rows as a title, such as `Column, one
    cycle of a sine, 0.4 g at 1.2 Hz, nonlinear equation`.
    """
    texts = {key: _same(rows, key) for key in keys}
    parts = []
    for key, text in texts.items():
        if key == "motion":
            parts += [motion_in_words(text) if text else "", _demand(rows, units)]
        elif key == "model" and text:
            parts.append(f"{text} equation{'s' * (' and ' in text)}")
        else:
            parts.append(text)
    return fill(literal(", ".join(filter(None, parts))), _TITLE)


def _same(rows: Rows, key: str) -> str:
    """Return the text of a column that is the same in all rows, else an empty one."""
    return (rows[0].get(key) or "") if len(groups(rows, key)) == 1 else ""


def _demand(rows: Rows, units: Units) -> str:
    """Return the amplitude and frequency that all rows share, such as `0.4 g at 1.2
    Hz`, empty without an amplitude.
    """
    found = []
    for keys in (("a_g", "demand_a", "demand_A"), ("omega_g", "Omega")):
        key = next((key for key in keys if rows[0].get(key) is not None), None)
        values = column(rows, key) if key else np.zeros(0)
        # the last digits of one demand differ between structures
        if key and np.ptp(values) <= 1e-9 * np.max(values):
            name, unit, factor = units.column(key)
            of = "" if unit else f"{name.removeprefix('demand_')} = "
            value = values[0] / factor
            found.append(f"{of}{value:.4g} {PLAIN.get(unit, unit)}".strip())
    return " at ".join(found)


def motion_in_words(name: str) -> str:
    """Return the name of a pulse as one says it: `one cycle of a sine`; another name as
    it is.
    """
    found = _CYCLES.fullmatch(name)
    if found is None:
        return name
    shape, count, more = found.groups()
    article = "an" if shape[0].lower() in "aeiou" else "a"
    return f"{_COUNTS.get(count, f'{count} cycles of')} {article} {shape}{more}"


def column_in(rows: Rows, name: str, units: Units) -> np.ndarray:
    """Return a column of numbers in these units."""
    return column(rows, name) / units.column(name)[2]


def series(rows: Rows, *keys: str) -> Iterator[tuple[Rows, dict[str, Any]]]:
    """Yield (rows, arguments of `plot`) for each line; its label is the texts in the
    columns `keys`.
    """
    for i, (texts, some) in enumerate(groups(rows, *keys).items()):
        yield some, {**line_style(i), "label": literal(", ".join(texts))}


def line_style(number: int) -> dict[str, Any]:
    """Return the colour (of the style) and the dash of a line as
    arguments of `plot`.
    """
    return {"color": f"C{number}", "ls": DASHES[number % len(DASHES)]}


def place(
    figure: Figure,
    axes: Axes,
    *,
    left: float,
    bottom: float,
    right: float = 0.12,
    top: float = 0.1,
) -> None:
    """Give the only axes of a figure these margins [inches], in place of a layout,
    which measures every text twice.
    """
    width, height = figure.get_size_inches()
    size = (1.0 - (left + right) / width, 1.0 - (bottom + top) / height)
    figure.set_layout_engine("none")
    axes.set_position((left / width, bottom / height, *size))


def panels(figure: Figure, count: int) -> list[Axes]:
    """Return `count` axes in rows of three; several have the size PANEL each. Raises
    UsageError for more than MOST_PANELS.
    """
    if count > MOST_PANELS:
        raise UsageError(f"found {count} panels; expected up to {MOST_PANELS}")
    across = panels_across(count)
    down = -(-count // across)
    if count > 1:
        figure.set_size_inches(PANEL[0] * across, PANEL[1] * down)
    axes = list(figure.subplots(down, across, squeeze=False).ravel())
    for spare in axes[count:]:
        spare.remove()
    return axes[:count]


def plain_ticks(axis: Any) -> None:
    """Write the values 1, 2 and 5 of each decade of a logarithmic axis as plain
    numbers.
    """
    from matplotlib.ticker import LogLocator, NullFormatter

    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.set_major_formatter("{x:g}")
    axis.set_minor_formatter(NullFormatter())


def panels_across(count: int) -> int:
    """Return how many panels stand in a row; four stand in two rows of two."""
    return 2 if count == 4 else min(count, MOST_ACROSS)


def legend(axes: Axes, handles: Sequence[Any] | None = None) -> None:
    """Add a legend below the figure if it is short, else beside it; none for a single
    line.
    """
    entries = axes.get_legend_handles_labels()[0] if handles is None else list(handles)
    if not entries or (handles is None and len(entries) < 2):
        return
    figure: Any = axes.figure
    longest = max(len(str(entry.get_label())) for entry in entries)
    width, height = figure.get_size_inches()
    # Axes of the caller, around which nothing makes room
    if not is_own(axes):
        axes.legend(handles=entries, fontsize="x-small", loc="best")
    elif len(entries) <= _MOST_BELOW and longest <= 34:
        across = min(len(entries), max(1, int(width / (0.065 * longest + 0.6))))
        figure.legend(handles=entries, loc="outside lower center", ncols=across)
        figure.set_size_inches(width, height + 0.18 * -(-len(entries) // across))
    else:
        figure.legend(handles=entries, loc="outside right upper")
        figure.set_size_inches(width + 0.065 * longest + 0.6, height)
