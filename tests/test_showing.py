"""Results show themselves shortly, become rows of pandas and are drawn from memory."""

import html
import re
import sys

import pandas as pd
import pytest

import rocking_cli
from rocking_cli import (
    ArgumentError,
    Curve,
    HazardCurve,
    OutputError,
    UsageError,
    boundaries,
    closed_form_curves,
    code_check,
    draw,
    draw_structures,
    drawn_verdict,
    envelope,
    intensity,
    load_records,
    load_structures,
    parse_documents,
    parse_grid,
    pulse,
    read_documents,
    read_motion,
    read_record,
    sine,
    slide_history,
    spectrum,
    time_history,
    trace_envelope,
)

# whose equation is quick: what stands here is computed whenever tests are collected
STATED = "parameters:p=2.1,alpha=0.2,eta=0.8,lambda=0.2"
DEMAND = "a_g=0.35g,f_g=1.5"
VERDICT = rocking_cli.check("block:0.5x2", sine(), DEMAND)
HISTORY = time_history("block:0.5x2", sine(), DEMAND)
SPECTRUM = spectrum("block:0.5x2", sine(), "a_g=0.1g:1g:5,f_g=0.5:5:4", workers=1)
RESULTS = {
    "verdict": VERDICT,
    "time history": HISTORY,
    "history": HISTORY.histories["nonlinear"],
    "spectrum": SPECTRUM,
    "block": load_structures("configs/block.yaml")[0],
    "arch": load_structures("configs/arch.yaml")[0],
    "two edges": load_structures("configs/rigid.yaml")[0],
    "record": read_record("configs/motions/synthetic.at2"),
    "recording": load_records("configs/motions/synthetic.at2", scale=2.0)[0],
    "curve": Curve(1.0, 0.4, 20),
    "drawn": drawn_verdict(
        "block:0.62+-0.01x2", sine(), "a_g=0.4g,f_g=1", n=16, a_max=None
    ),
    "interval": trace_envelope(STATED, sine(), [3.0])[0],
    "point": closed_form_curves([3.0], 0.9)[0],
    "record's motion": read_motion("configs/motions/synthetic.at2"),
    "pulse": pulse("ricker-symmetric"),
    "intensity": intensity("configs/motions/synthetic.at2"),
    "summary": SPECTRUM.summary,
    "code": code_check("block:0.5x2", "sine", DEMAND),
    "slide": slide_history("block:0.5x2,friction=0.2", "sine", DEMAND),
    "boundary": boundaries("block:0.5x2", "width=0.5:0.6:2", "sine", DEMAND)[0][0],
    "hazard": HazardCurve([0.5, 1.0], [1e-2, 1e-3]),
}


@pytest.mark.parametrize("name", RESULTS)
def test_a_result_is_shown_in_at_most_fifteen_lines(name):
    one = RESULTS[name]
    lines = repr(one).splitlines()
    assert lines[0].startswith(type(one).__name__)
    assert len(lines) <= 15
    assert max(map(len, lines)) <= 110
    table = one._repr_html_()
    assert table.startswith("<table>")
    cells = re.findall(r"<td[^>]*>(.*?)</td>", table)
    for line in lines[1:4]:  # the same texts
        assert html.escape(line.split("  ")[-1].strip()) in cells


def test_inputs_show_themselves_in_a_line():
    (document,) = read_documents("configs/parameters.yaml")
    assert repr(document) == (
        f"Document(configs/parameters.yaml: {', '.join(document.values)})"
    )
    axis = parse_grid("a_g=0.1g:1g:50,f_g=0.5:5:40").amplitude
    assert repr(axis) == "Axis(a_g: 50 values, 0.981 to 9.81 m/s2)"
    found = rocking_cli.linear_response("sine", [0.9, 1.5, 1.6], 6.0, 0.9)
    assert repr(found) == "Response(3 cells: 1 no_uplift, 2 rocked)"


def test_a_verdict_tells_its_capacity_to_pandas():
    table = pd.DataFrame([VERDICT])
    assert table.capacity_demand[0] == VERDICT.capacity_demand
    assert VERDICT.capacity_demand == VERDICT.first_overturning_a / VERDICT.demand_a
    assert VERDICT.to_pandas().capacity_demand[0] == VERDICT.capacity_demand
    stands = rocking_cli.check("block:2x2,restitution=0.5", sine(), DEMAND, a_max=None)
    assert stands.capacity_demand is None


def test_rows_become_a_table_of_pandas():
    history = HISTORY.to_pandas()
    assert list(history.columns[:3]) == ["t", "theta", "theta_dot"]
    cells = SPECTRUM.to_pandas()
    assert len(cells) == SPECTRUM.outcome.size
    own = SPECTRUM.to_xarray().theta_ratio.to_dataframe().theta_ratio
    assert cells.theta_ratio.to_numpy() == pytest.approx(own.to_numpy(), nan_ok=True)
    record = RESULTS["record"]
    assert list(record.to_pandas().acceleration) == record.acceleration.tolist()
    assert RESULTS["recording"].to_pandas().acceleration.abs().max() == pytest.approx(
        RESULTS["recording"].acceleration
    )


def test_without_pandas_one_sentence_says_so(monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(OutputError, match="to_pandas needs pandas: pip install pandas"):
        VERDICT.to_pandas()


def test_a_structure_may_be_a_text_a_path_a_document_or_parameters(tmp_path):
    (document,) = read_documents("configs/block.yaml")
    (built,) = load_structures("configs/block.yaml")
    found = {
        rocking_cli.check(one, sine(), DEMAND, a_max=None).theta_ratio
        for one in ("configs/block.yaml", document, built)
    }
    assert len(found) == 1
    both = spectrum([built, "block:0.5x2"], sine(), "A=2,Omega=5", workers=1)
    assert [s.name for s in both.scene.structures] == ["Column", "block:0.5x2"]
    two = tmp_path / "two.yaml"
    two.write_text("kind: block\nwidth: 1\nheight: 4\n---\n" + document.text)
    with pytest.raises(UsageError, match=r"found 2 structures .two, Column.; expected"):
        rocking_cli.check(two, sine(), DEMAND)


@pytest.fixture
def axes():
    figure = pytest.importorskip("matplotlib.figure").Figure()
    return figure.subplots()


def test_a_response_in_memory_goes_into_one_axes(axes):
    assert draw(HISTORY, axes) is axes
    (line,) = axes.lines
    rows = HISTORY.to_pandas()
    assert line.get_xdata() == pytest.approx(rows.t.to_numpy())
    assert line.get_ydata() == pytest.approx(rows.theta.to_numpy())


@pytest.mark.parametrize(
    "result",
    [
        SPECTRUM,
        VERDICT,
        [VERDICT, VERDICT],
        trace_envelope(STATED, sine(), [3.0, 4.0]),
        closed_form_curves([3.0, 4.0], 0.9),
        envelope("block:0.5x2", sine(), "f_g=1:1.5:2"),
        load_records("configs/motions/synthetic.at2", scale=2.0),
    ],
    ids=lambda result: type(result).__name__,
)
def test_a_result_in_memory_is_drawn(axes, result):
    draw(result, axes)
    assert axes.lines or axes.collections


def test_a_spectrum_in_memory_is_drawn_as_its_file(axes, tmp_path):
    path = tmp_path / "s.h5"
    demand = "a_g=0.1g:1g:5,f_g=0.5:5:4"
    rocking_cli.write_spectrum("block:0.5x2", sine(), demand, path, workers=1)
    own, other = axes, axes.figure.add_subplot()
    draw(SPECTRUM, own, cut="f_g=2")
    draw(path, other, cut="f_g=2")
    assert own.get_title() == other.get_title()
    for mine, its in zip(own.lines, other.lines, strict=True):
        assert mine.get_ydata() == pytest.approx(its.get_ydata(), nan_ok=True)


def test_a_structure_is_drawn_into_axes(axes):
    draw_structures(load_structures("configs/arch.yaml"), axes)
    assert axes.patches
    with pytest.raises(UsageError, match="found 2 structures; expected one"):
        draw_structures(["block:0.5x2", "block:0.4x2"], axes)
    stated = load_structures("configs/parameters.yaml")
    with pytest.raises(rocking_cli.DocumentError):
        draw_structures(stated, axes)


@pytest.mark.parametrize("wrong", [3, None, [object()]])
def test_what_cannot_be_drawn_is_told(axes, wrong):
    with pytest.raises(ArgumentError, match=r"draw: `source`: found a .*; expected a"):
        draw(wrong, axes)


def test_a_repeated_name_gets_a_number():
    (document,) = parse_documents("{name: a, kind: block, width: 1, height: 4}")
    both = spectrum([document, document], sine(), "A=2,Omega=5", workers=1)
    assert [s.name for s in both.scene.structures] == ["a", "a-2"]


def test_a_response_is_drawn_up_to_the_loss_of_contact_by_each_equation(axes):
    body = "block:2x2,restitution=0.5"
    lost = time_history(body, "sine", "a_g=6g,f_g=5", ["linear", "nonlinear"])
    draw(lost, axes)
    ends = [max(x for x, y in line.get_xydata() if y == y) for line in axes.lines[:2]]
    assert ends == pytest.approx([0.1043, 0.1081], abs=3e-4)
