"""The program as a whole at the shell: unknown words, pipes, full disks, help, start-up."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import click
import pytest
from click.shell_completion import ShellComplete
from support.watched_processes import PROGRAM

from rocking_cli.commands import COMMANDS, cli, main


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["parms"], "rocking: No such command 'parms' (did you mean 'params'?) (see --help)"),
        (["params", "--jsn"], "rocking params: No such option --jsn (did you mean '--json'?) (see --help)"),
        (["response", "x", "--pga=0.3g"], "rocking response: No such option --pga (did you mean '--a-g'?) (see --help)"),
        (["response", "x", "--a_g", "0.3g"], "rocking response: No such option --a_g (did you mean '--a-g'?) (see --help)"),
        (["response", "x", "-pulse", "sine"], "rocking response: No such option -pulse (did you mean '--pulse'?) (see --help)"),
        (["convert", "--frobnicate"], "rocking convert: No such option --frobnicate (see --help)"),
    ],
    ids=lambda x: x if isinstance(x, str) else " ".join(x),
)
def test_an_unknown_command_or_option_names_the_one_that_was_meant(refused, arguments, said):
    assert refused(2, *arguments) == f"{said}\n"


@pytest.mark.parametrize(
    ("code", "arguments", "said"),
    [
        (2, ["envelope", "--eta", "0.9", "--grid", "Omega=5", "--pulse", "Ricker"], "did you mean 'ricker-symmetric' or 'ricker-antisym"),
        (2, ["envelope", "--eta", "0.9", "--grid", "Omega=5", "--model", "nonlin"], "did you mean 'nonlinear'"),
        (2, ["envelope", "--eta", "0.9", "--grid", "omega=5"], "did you mean 'Omega' or 'omega_g'"),
        (2, ["spectrum", "--eta", "0.9", "-o", "x.h5", "--grid", "pga=5"], "did you mean 'a_g'"),
        (3, ["params", "-"], "did you mean 'restitution'"),
    ],
    ids=lambda x: x[-1] if isinstance(x, list) else "",
)
def test_an_unknown_word_names_the_one_that_was_meant(refused, code, arguments, said):
    assert said in refused(code, *arguments, stdin="{kind: block, width: 1, height: 4, eta: 0.9}")


SINGLE = [
    (command, option.opts[-1])
    for command in COMMANDS
    for option in cli.get_command(click.Context(cli), command).params
    if isinstance(option, click.Option) and not option.multiple and not option.is_flag
]


@pytest.mark.parametrize(("command", "option"), SINGLE, ids=" ".join)
def test_a_single_valued_option_is_not_taken_twice(command, option):
    with pytest.raises(click.UsageError, match=f"^{option} is given twice; expected one value$"):
        cli.main([command, option, "1", option, "2"], standalone_mode=False)


def test_all_ways_to_write_a_repetition_are_seen(refused):
    wanted = "rocking spectrum: --output is given twice; expected one value (see --help)\n"
    assert refused(2, "spectrum", "-o", "a.h5", "--output=b.h5") == wanted
    assert refused(2, "spectrum", "x.yaml", "-oa.h5", "y.yaml", "-o", "a.h5") == wanted
    assert "--json does not go with --csv" in refused(2, "params", "configs/block.yaml", "--json", "--csv")


def test_repeatable_options_flags_and_values_that_look_like_options_are_taken(rocking):
    twice = rocking("envelope", "--eta", "0.9", "--eta", "0.8", "--grid", "Omega=5", "--csv", "--csv", "-q", "-q")
    assert {line.split(",")[0] for line in twice.stdout.splitlines()[1:]} == {"eta=0.9", "eta=0.8"}
    assert "--grid: cannot be read" in rocking("params", "--", "--grid", "--grid").stderr


def test_a_closed_pipe_is_no_error(tmp_path):
    document = tmp_path / "b.yaml"
    document.write_text("kind: block\nwidth: 1\nheight: 5")
    call = f"{sys.executable} -m rocking_cli params {document} --vary height=2:9:50000 --csv"
    done = subprocess.run(["bash", "-c", f"set -o pipefail; {call} | head -n 2"], capture_output=True, text=True, check=False)
    assert done.returncode == 0
    assert done.stderr == ""
    assert len(done.stdout.splitlines()) == 2


def test_a_full_disk_is_one_sentence(tmp_path, pytestconfig):
    with open("/dev/full", "w") as full:
        done = subprocess.run(
            [*PROGRAM, "params", str(pytestconfig.rootpath / "configs/block.yaml"), "--json"],
            stdout=full, stderr=subprocess.PIPE, text=True, check=False,
        )  # fmt: skip
    assert done.returncode == 1
    assert done.stderr == "rocking: standard output: cannot be written: No space left on device\n"


@pytest.mark.parametrize("command", [[], ["params"], ["spectrum"], ["envelope"]])
def test_help_shows_an_example_that_runs(rocking, command):
    done = rocking(*command, "--help")
    assert done.returncode == 0
    example = " ".join(done.stdout[done.stdout.index("Example: rocking") + len("Example: rocking") :].split()).split(" | ")[0]
    ran = rocking(*example.split())
    assert ran.returncode == 0, ran.stderr


RECORD = "configs/motions/synthetic.at2"
BODY = "rocking_cli.dynamics.equations.rigid_body"
LOSS = "rocking_cli.dynamics.observers.contact_loss"
FORCES = [f"rocking_cli.dynamics.observers.{name}" for name in ("ground_forces", "forces")]


@pytest.mark.parametrize(
    ("arguments", "unwanted"),
    [
        (["--help"], ["numpy", "scipy", "h5py", "yaml"]),
        (["params", "configs/block.yaml"], ["numpy", "scipy", "h5py"]),
        (["envelope", "--eta", "0.9", "--grid", "Omega=5", "--a-max", "2"], ["scipy", "h5py", "multiprocessing"]),
        (
            ["spectrum", "--eta", "0.9", "--grid", "A=1:2:2,Omega=1:2:2", "-q", "-o", "OUT"],
            [
                "scipy",
                "yaml",
                "numpy.random",
                "numpy.ma",
                "rocking_cli.motions.records",
                "rocking_cli.spectra.file.reader",
                BODY,
                LOSS,
            ],
        ),
        (
            ["spectrum", "block:0.5x2", "--model", "nonlinear", "--grid", "a_g=0.1g:1g:3,f_g=1:5:3", "-o", "OUT"],
            ["scipy", "rocking_cli.motions.records", "rocking_cli.structures.kinds.arch", "rocking_cli.dynamics.samples.exact", *FORCES],
        ),
        (
            ["spectrum", "block:0.5x2", "--model", "nonlinear", "--motion", RECORD, "--grid", "a_g=0.1g:0.5g:3", "-o", "OUT"],
            ["scipy", "rocking_cli.structures.kinds.arch", *FORCES],
        ),
        (["response", "block:0.5x2", "--a-g", "0.3g", "--f-g", "1", "--events"], ["h5py", *FORCES]),
    ],
    ids=lambda x: x[0],
)
def test_commands_import_only_what_they_use(arguments, unwanted, pytestconfig, tmp_path):
    arguments = [str(tmp_path / "s.h5") if x == "OUT" else x for x in arguments]
    code = (  # NumPy before its version 2 imports its own `random` and `ma`
        "import sys\nfrom rocking_cli.commands import main\n"
        f"try: main({arguments!r})\nexcept SystemExit as e: assert not e.code, e.code\n"
        "own = ['numpy.random', 'numpy.ma'] if 'numpy' in sys.modules and sys.modules['numpy'].__version__ < '2' else []\n"
        "print(*(name for name in sys.modules if name not in own), file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=pytestconfig.rootpath)
    assert not set(unwanted) & set(done.stderr.split())


@pytest.mark.parametrize(
    ("arguments", "most"),
    [
        (["check", "configs/block.yaml", "--a-g", "0.35g", "--f-g", "1.5"], 12_000),
        (["spectrum", "--eta", "0.9", "--grid", "A=1:2:2,Omega=1:2:2", "-q", "-o", "OUT"], 10_000),
    ],
    ids=["check", "spectrum"],
)
def test_commands_load_no_more_lines_of_the_package_than_now(arguments, most, pytestconfig, tmp_path):
    """What a newcomer has to read to follow one command."""
    arguments = [str(tmp_path / "s.h5") if x == "OUT" else x for x in arguments]
    code = (
        "import sys\nfrom rocking_cli.commands import main\n"
        f"try: main({arguments!r})\nexcept SystemExit as e: assert not e.code, e.code\n"
        "print(*(m.__file__ for n, m in list(sys.modules.items()) if n.partition('.')[0] == 'rocking_cli'), sep='\\n', file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=pytestconfig.rootpath)
    files = [Path(line) for line in done.stderr.splitlines() if line.endswith(".py")]
    assert len(files) > 50
    assert sum(len(file.read_text().splitlines()) for file in files) <= most


@pytest.mark.parametrize(("given", "kept"), [(None, "1"), ("3", "3")])
def test_openblas_has_one_thread_unless_the_user_says_otherwise(monkeypatch, given, kept):
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", given or "")  # so that it is put back afterwards
    if given is None:
        monkeypatch.delenv("OPENBLAS_NUM_THREADS")
    monkeypatch.setattr("rocking_cli.commands.listen", lambda: None)
    with pytest.raises(SystemExit, match=r"^0$"):
        main(["--version"])
    assert os.environ["OPENBLAS_NUM_THREADS"] == kept


@pytest.mark.parametrize(
    ("words", "completed"),
    [
        (["sp"], ["spectrum"]),
        (["help", "do"], ["documents"]),
        (["envelope", "--pulse", "ric"], ["ricker-symmetric", "ricker-antisymmetric"]),
        (["compare", "--model", ""], ["linear", "nonlinear", "both"]),
        (["check", "--vertical", "cos"], ["cosine", "cos"]),  # a pulse, or what there is of files
    ],
    ids=lambda x: " ".join(x),
)
def test_words_are_completed(words, completed):
    found = ShellComplete(cli, {}, "rocking", "_ROCKING_COMPLETE").get_completions(words[:-1], words[-1])
    assert [item.value for item in found] == completed


FILES = [
    (name, parameter.name)
    for name in COMMANDS
    for parameter in cli.get_command(click.Context(cli), name).params
    if parameter.name in ("file", "files", "spectrum", "motion", "output", "pulses", "counts", "vertical")
]


@pytest.mark.parametrize(("command", "parameter"), FILES, ids=" ".join)
def test_every_shell_completes_files(command, parameter):
    context = click.Context(cli.get_command(click.Context(cli), command))
    (found,) = (p for p in context.command.params if p.name == parameter)
    assert [item.type for item in found.shell_complete(context, "con")] == ["file"]  # no pulse begins like this


def test_shell_completion(tmp_path):
    program = [sys.executable, "-c", "from rocking_cli.commands import main; main()"]
    env = {**os.environ, "_ROCKING_COMPLETE": "bash_complete", "COMP_WORDS": "rocking sp", "COMP_CWORD": "1"}
    assert "plain,spectrum" in subprocess.run(program, env=env, capture_output=True, text=True, check=False).stdout


def test_every_command_with_a_table_takes_units(refused):
    for command in ("params", "envelope", "records", "response", "compare", "predict", "accuracy", "convert", "info"):
        assert "--units: found 'x'" in refused(2, command, "--units", "x", "none.yaml")
