"""The program as a whole at the shell: unknown words, pipes, full disks, help,
start-up.
"""

import os
import subprocess
import sys
import tokenize
from pathlib import Path

import click
import pytest
from click.shell_completion import ShellComplete

from rocking_cli import sine, write_spectrum
from rocking_cli.commands import COMMANDS, cli

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.parametrize("command", COMMANDS)
def test_a_single_valued_option_is_not_taken_twice(command):
    for option in cli.get_command(click.Context(cli), command).params:
        if isinstance(option, click.Option) and not (option.multiple or option.is_flag):
            name = option.opts[-1]
            with pytest.raises(
                click.UsageError, match=f"^{name} is given twice; expected one value$"
            ):
                cli.main([command, name, "1", name, "2"], standalone_mode=False)


def test_an_option_means_one_thing_in_every_command():
    """Help texts of options of one name are compared by their first words, but for
    those that ask for the same thing differently.
    """
    alike = {
        "--vary",
        "--column",
        "--json",
        "--output",
        "-o",
        "--title",
        "--sign",
        "--model",
        "--eta",
        "--grid",
        "--seed",
        "--draws",
        "--sort",
        "--by",
    }
    meanings: dict[str, dict[str, str]] = {}
    for command in COMMANDS:
        for option in cli.get_command(click.Context(cli), command).params:
            for name in option.opts if isinstance(option, click.Option) else ():
                meanings.setdefault(name, {})[str(option.help)] = command
    assert {
        name: said
        for name, said in meanings.items()
        if len(said) > 1 and name not in alike
    } == {}


@pytest.mark.parametrize(
    ("call", "new"),
    [
        ("plot x.h5 --phase", "--phase-portrait"),
        ("spectrum --check 2", "--verify-cells"),
    ],
)
def test_an_old_name_of_an_option_is_refused(refused, call, new):
    assert f"did you mean '{new}'?" in refused(2, *call.split())


def test_repeatable_options_flags_and_values_that_look_like_options_are_taken(rocking):
    twice = rocking(
        "envelope",
        "--eta",
        "0.9",
        "--eta",
        "0.8",
        "--grid",
        "Omega=5",
        "--csv",
        "--csv",
        "-q",
        "-q",
    )
    assert {line.split(",")[0] for line in twice.stdout.splitlines()[1:]} == {
        "eta=0.9",
        "eta=0.8",
    }
    assert (
        "--grid: cannot be read" in rocking("params", "--", "--grid", "--grid").stderr
    )


ONE_SIDED = "kind: wall\nname: w\nthickness: 0.5\nheight: 2\none_sided: true\n"
TIED = (
    "kind: block\nname: w\nwidth: 0.5\nheight: 2\nmass: 2 t\nties: [{height: 2,"
    " stiffness: 1e4, side: right}]\n"
)


@pytest.mark.slow
def test_a_command_that_computes_one_direction_of_unequal_sides_says_so(
    rocking, tmp_path
):
    (tmp_path / "w.yaml").write_text(ONE_SIDED)
    (tmp_path / "p.csv").write_text(
        "a_g,T_g\n" + "".join(f"{0.3 + 0.05 * i} g,{0.5 + 0.1 * i}\n" for i in range(4))
    )
    at, sweep = (
        ("--a-g", "0.3g", "--f-g", "2"),
        ("--grid", "a_g=0.1g:0.3g:2,f_g=2", "-o"),
    )
    pulses = ("--pulses", "p.csv", "--bootstrap", "0", "--levels")
    calls = [
        ("compare", *at),
        ("spectrum", *sweep, "w.h5"),
        ("fragility", *pulses, "0.3g:2g:4"),
        ("fragility", *pulses, "0.01g:0.02g:2"),
    ]
    line = (
        "one direction of the motion only, though the sides differ: w; the other {}"
        " gives the opposite one\n"
    )
    for name, *more in calls:  # the last one has no fit
        assert (
            line.format("sign of --scale (1 if not given)")
            in rocking(name, "w.yaml", *more).stderr
        )
    assert (
        line.format("--sign")
        in rocking("solve", "w.yaml", "--vary", "thickness=0.4:0.5:2", *at).stderr
    )
    for name, side, told in (("t.yaml", "right", True), ("w.yaml", "both", False)):
        (tmp_path / name).write_text(TIED.replace("right", side))
        assert ("one direction" in rocking("compare", name, *at).stderr) is told


RECORD = "configs/motions/synthetic.at2"
ARCH, RECORDS = "rocking_cli.structures.kinds.arch", "rocking_cli.motions.records"
BODY = "rocking_cli.dynamics.equations.rigid_body"
WATCH = "rocking_cli.dynamics.observers.contact_watch"


LOADED = """
import sys
from rocking_cli.commands import main

try:
    main({words!r})
except SystemExit as ended:
    assert not ended.code, ended.code
# NumPy before its version 2 imports these itself
old = "numpy" in sys.modules and sys.modules["numpy"].__version__ < "2"
own = ["numpy.ma", "numpy.random"] if old else []
for name, module in list(sys.modules.items()):
    if name not in own:
        print(name, vars(module).get("__file__"), file=sys.stderr)
"""


def loaded(arguments: str, folder: Path) -> dict[str, str]:
    """The modules that a call has loaded, with their files."""
    words = arguments.replace("OUT", str(folder / "s.h5")).split()
    code = LOADED.format(words=words)
    done = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        check=True,
        cwd=ROOT,
    )
    return dict(line.split(" ", 1) for line in done.stderr.splitlines() if " " in line)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "unwanted"),
    [
        ("--help", ["numpy", "scipy", "h5py", "yaml"]),
        ("params configs/block.yaml", ["numpy", "scipy", "h5py"]),
        (
            "envelope --eta 0.9 --grid Omega=5 --a-max 2",
            ["scipy", "h5py", "multiprocessing"],
        ),
        (
            "spectrum --eta 0.9 --grid A=1:2:2,Omega=1:2:2 -q -o OUT",
            [
                "scipy",
                "yaml",
                "html",
                "numpy.ma",
                "numpy.random",
                RECORDS,
                "rocking_cli.spectra.file.reader",
                BODY,
                WATCH,
            ],
        ),
        pytest.param(
            "spectrum block:0.5x2 --model nonlinear --grid a_g=0.1g:1g:3,f_g=1:5:3"
            " -o OUT",
            ["scipy", "yaml", RECORDS, ARCH],
            marks=pytest.mark.soak,
        ),
        (
            f"spectrum block:0.5x2 --model nonlinear --motion {RECORD} --grid"
            " a_g=0.1g:0.5g:3 -o OUT",
            ["scipy", ARCH],
        ),
        ("response block:0.5x2 --a-g 0.3g --f-g 1 --events", ["h5py", "yaml"]),
    ],
    ids=lambda x: x[:12],
)
def test_commands_import_only_what_they_use(arguments, unwanted, tmp_path):
    assert not set(unwanted) & loaded(arguments, tmp_path).keys()


def code_tokens(file: Path) -> int:
    """The names, operators, numbers and strings of a file: what a reader holds in his
    head, however it is laid out.
    """
    layout = (
        tokenize.COMMENT,
        tokenize.NL,
        tokenize.NEWLINE,
        tokenize.INDENT,
        tokenize.DEDENT,
        tokenize.ENDMARKER,
        tokenize.ENCODING,
    )
    # Python 3.12 and later give the parts of an f-string, 3.11 one string.
    begins = getattr(tokenize, "FSTRING_START", None)
    ends = getattr(tokenize, "FSTRING_END", None)
    counted, inside = 0, 0
    with tokenize.open(file) as text:
        for token in tokenize.generate_tokens(text.readline):
            inside += token.type == begins
            counted += not inside and token.type not in layout
            if token.type == ends:
                inside -= 1
                counted += not inside
    return counted


@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "most"),
    [
        ("check configs/block.yaml --a-g 0.35g --f-g 1.5", 150_000),
        pytest.param(
            "spectrum --eta 0.9 --grid A=1:2:2,Omega=1:2:2 -q -o OUT",
            114_000,
            marks=pytest.mark.soak,
        ),
    ],
    ids=["check", "spectrum"],
)
def test_commands_load_no_more_code_of_the_package_than_now(arguments, most, tmp_path):
    """The code that a newcomer has to read to follow one command."""
    files = [
        Path(file)
        for name, file in loaded(arguments, tmp_path).items()
        if name.partition(".")[0] == "rocking_cli"
    ]
    assert len(files) > 50
    assert sum(map(code_tokens, files)) <= most


@pytest.mark.parametrize(("given", "kept"), [(None, "1"), ("3", "3")])
def test_openblas_has_one_thread_unless_the_user_says_otherwise(
    rocking, monkeypatch, given, kept
):
    monkeypatch.setenv(
        "OPENBLAS_NUM_THREADS", given or ""
    )  # so that it is put back afterwards
    if given is None:
        monkeypatch.delenv("OPENBLAS_NUM_THREADS")
    assert rocking("--version").returncode == 0
    assert os.environ["OPENBLAS_NUM_THREADS"] == kept


@pytest.mark.parametrize(
    ("words", "completed"),
    [
        (["sp"], ["spectrum"]),
        (["help", "do"], ["documents"]),
        (["envelope", "--pulse", "ric"], ["ricker-symmetric", "ricker-antisymmetric"]),
        (["compare", "--model", ""], ["linear", "nonlinear", "both"]),
        (["params", "configs/block.yaml", "--vary", "h"], ["height="]),
        (["solve", "--vary", "gyr"], ["gyration="]),
        (["plot", "none.h5", "--structure", "x"], []),
        (
            ["check", "--vertical", "cos"],
            ["cosine", "cos"],
        ),  # a pulse, or what there is of files
    ],
    ids=lambda x: " ".join(x),
)
def test_words_are_completed(words, completed):
    found = ShellComplete(cli, {}, "rocking", "_ROCKING_COMPLETE").get_completions(
        words[:-1], words[-1]
    )
    assert [item.value for item in found] == completed


def test_names_in_a_spectra_file_are_completed(tmp_path):
    path = tmp_path / "s.h5"
    write_spectrum(["block:0.5x2", "block:1x4"], sine(), "A=2,Omega=5", path, workers=1)
    found = ShellComplete(cli, {}, "rocking", "_ROCKING_COMPLETE").get_completions(
        ["plot", str(path), "--structure"], "block:1"
    )
    assert [item.value for item in found] == ["block:1x4"]


FILES = [
    (name, parameter.name)
    for name in COMMANDS
    for parameter in cli.get_command(click.Context(cli), name).params
    if parameter.name
    in ("file", "files", "spectrum", "motion", "output", "pulses", "counts", "vertical")
]


@pytest.mark.parametrize(("command", "parameter"), FILES, ids=" ".join)
def test_every_shell_completes_files(command, parameter):
    context = click.Context(cli.get_command(click.Context(cli), command))
    (found,) = (p for p in context.command.params if p.name == parameter)
    assert [item.type for item in found.shell_complete(context, "con")] == [
        "file"
    ]  # no pulse begins like this


def test_shell_completion(tmp_path):
    program = [sys.executable, "-c", "from rocking_cli.commands import main; main()"]
    env = {
        **os.environ,
        "_ROCKING_COMPLETE": "bash_complete",
        "COMP_WORDS": "rocking sp",
        "COMP_CWORD": "1",
    }
    assert (
        "plain,spectrum"
        in subprocess.run(
            program, env=env, capture_output=True, text=True, check=False
        ).stdout
    )
