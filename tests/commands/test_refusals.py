"""Calls that are refused: the exit code, and the words of the one sentence that says
why.
"""

import shlex

import pytest

FILES = {
    "stated.yaml": "{kind: parameters, p: 2.1, alpha: 0.2, eta: 0.8, lambda: 0.2}",
    "pair.yaml": (
        "{kind: block, width: 1, height: 4}\n---\n{kind: block, width: 1, height: 6}"
    ),
    "kilograms.yaml": "kind: block\nwidth: 2 kg\nheight: 1",
    "tiny.yaml": (
        "kind: parameters\np: 1\nalpha: 1e-30\nlambda: 1e-30\neta: 0.9\ngravity: 0.01"
    ),
    "empty": "",
    "tab.yaml": "kind: block\n\twidth: 1\n",
    "percent.yaml": "{kind: block, width: 1, height: 4, restitution: 90%}",
    "site.csv": "T [s],S_a [g]\n0,0.2\n0.15,0.5\n0.5,0.5\n2,0.12\n5,0.03\n",
    "both.csv": "T,S_a [g],Se [g]\n0,1,2\n1,2,3\n",
    "column.txt": "0\n1\n",
    "header.at2": (
        "PEER NGA STRONG MOTION DATABASE RECORD\nNowhere\nACCELERATION TIME SERIES IN"
        " UNITS OF G\n"
    ),
    "more.csv": "im,n,z\n0.2,10,1\n0.4,10,14\n0.6,10,8\n",
    "counts.csv": "im,n,z\n0.2,10,1\n0.4,10,4\n0.6,10,8\n",
    "x.csv": "im,n,z\n0.2,40,x\n",
    "short.csv": "im,n\n0.2,40\n",
    "params.csv": "base_radius,height,p\n1,2,3\n",
    "there.h5": "mine",
    "there.html": "mine",
    "there.svg": "mine",
}
AT2, SITE = (
    "--motion configs/motions/synthetic.at2",
    "--pulses configs/motions/site_pulses.csv",
)
RATES = "--hazard configs/hazard.csv"
SMALL, LEVELS = "--grid A=0.5:9:40,Omega=0.5:12:30 -o s.h5", "--levels 0.2g:0.45g:4"
AT = "--a-g 0.35g --f-g 1.2"
COLUMN = "configs/block.yaml"
REFUSED = {
    "": [
        (
            2,
            "parms",
            "rocking: No such command 'parms' (did you mean 'params'?) (see --help)\n",
        ),
        (
            2,
            "params --jsn",
            (
                "rocking params: No such option --jsn (did you mean '--json'?) (see"
                " --help)\n"
            ),
        ),
        (
            2,
            "convert --frobnicate",
            "rocking convert: No such option --frobnicate (see --help)\n",
        ),
        (
            2,
            "response c.yaml --motion a.txt b.txt",
            (
                "Got unexpected extra argument (b.txt); expected one FILE after each"
                " --motion"
            ),
        ),
        (
            2,
            "help document",
            "No such command or topic 'document' (did you mean 'documents'?)",
        ),
        (
            2,
            "help dampers",
            (
                "No such command or topic 'dampers'; it stands in `rocking help"
                " documents`, `rocking help ties`"
            ),
        ),
        (
            2,
            "help Omega",
            "No such command or topic 'Omega'; it stands in `rocking help words`, ",
        ),
        (2, "init", "Missing argument 'KIND'. Choose from: block, point_mass, "),
    ],
    "accuracy": [
        (2, "pair.yaml --grid A=1:2:2,Omega=1:2:2", "found 2 structures; expected one")
    ],
    "check": [
        (
            2,
            f"{COLUMN} --a-g 0.3g --f-g 0.5:2 --sign -",
            "--sign - does not go with a range of frequencies",
        ),
        (
            2,
            f"{COLUMN} {AT} --verdict-only --sort capacity",
            "--sort needs the capacities, which --verdict-only does not search",
        ),
        (2, "stated.yaml", "no shaking"),
        (
            2,
            "stated.yaml --a-g 0.3g",
            "--a-g alone is no motion: give a range of frequencies",
        ),
        (2, "stated.yaml --azimuth 30", "--azimuth goes with a record: give --motion"),
        (2, "- --motion -", "standard input is given both as structure and as motion"),
        (2, f"{AT}", "no structure: give FILE (- for standard input) (see --help)\n"),
        (2, "stated.yaml --a-g 0 --f-g 1", "the amplitude is 0"),
        (
            2,
            "stated.yaml --a-g 1:2:3 --f-g 1",
            "--a-g: found '1:2:3'; expected one value",
        ),
        (2, f"stated.yaml {AT} --fc 1.2", "--fc goes with --code"),
        (2, f"stated.yaml {AT} --a-max nan", "expected a number A, or an acceleration"),
        (2, f"stated.yaml {AT} -o there.svg", "exists; use --overwrite"),
        (2, f"stated.yaml {AT} -o check.txt", "ends in .png"),
        (
            2,
            f"stated.yaml --vertical station {AT}",
            "--vertical station goes with a record: give --motion",
        ),
    ],
    "check --code ntc2018": [
        (2, f"{COLUMN}", "or --motion FILE, or --spectrum FILE"),
        (
            2,
            f"configs/frame.yaml configs/parameters.yaml {AT}",
            "found Temple front (kind frame), Measured arch (kind parameters)",
        ),
        (
            2,
            f"{COLUMN} {AT} --fc 0.5",
            "--fc: found 0.5; expected a confidence factor from 1",
        ),
        (
            2,
            f"{COLUMN} {AT} --floor T=1",
            "--floor: T=1: no key 'xi'; expected xi: a number without a unit",
        ),
        (
            2,
            f"{COLUMN} {AT} --floor T=1,xi=5%,gamma_psi=1",
            "xi: found 5%; expected a number without a unit; did you mean 0.05?",
        ),
        (
            2,
            f"{COLUMN} --spectrum site.csv --fail-on overturning",
            "--fail-on needs a motion",
        ),
        (
            3,
            f"{COLUMN} --spectrum both.csv",
            "both.csv:2:3: found both S_a and Se; expected one of them",
        ),
    ],
    "compare": [
        (2, COLUMN, "no shaking"),
        (
            2,
            f"{COLUMN} --motion a.yaml --motion b.yaml",
            "found a.yaml b.yaml; expected one motion",
        ),
        (2, "block:0.5x2,one_sided=true --A 2 --Omega 4 --eta 0.5", "--eta: "),
    ],
    "draw": [
        (2, "block:0.5x2 -o there.svg", "exists; use --overwrite"),
        (3, "configs/parameters.yaml -o x.svg", "states no geometry to draw"),
        (
            2,
            f"{'block:0.5x2 ' * 13} -o x.svg",
            "found 13 structures; expected at most 12 for a figure",
        ),
    ],
    "envelope": [
        (2, "--grid f_g=1", "or --eta"),
        (2, COLUMN, "no --grid"),
        (2, "--eta nan --grid Omega=5", "--eta: found 'nan'"),
        (2, "--eta 0.9 --grid A=1:2:3", "one axis"),
        (2, "--eta 0.9 --grid omega=5", "did you mean 'Omega' or 'omega_g'"),
        (2, "--eta 0.9 --grid omega_g=1:2:3", "no units"),
        (2, "--eta 0.9 --grid Omega=1:2:3 --a-max 0.5", "a-max"),
        (2, "--eta 0.9 --grid Omega=1:2:3 --a-max 1e308", "a-max"),
        (
            2,
            "--eta 0.9 --grid Omega=5 --a-max 1g",
            "--a-max: found an acceleration; expected a number A",
        ),
        (
            2,
            "--eta 0.9 --grid Omega=1:2:1000000 --cycles 1e5 --a-max 1e5",
            "which would take years; expected up to",
        ),
        (2, "--eta 0.9 --grid Omega=5 --model nonlin", "did you mean 'nonlinear'"),
        (2, "--eta 0.9 --grid Omega=1:2:3 --model nonlinear", "needs a critical angle"),
        (
            2,
            f"{COLUMN} --linear-uplift lambda --model both --grid Omega=4",
            "goes with --model linear",
        ),
        (2, "--eta 0.9 --grid Omega=1:2:3 --tolerance 0", "tolerance"),
        (
            2,
            "--eta 0.9 --grid Omega=1:2:3 --pulse cosine --closed-form",
            "--closed-form",
        ),
        (
            2,
            "--eta 0.9 --grid Omega=2 --vertical sine",
            "no weight that a vertical motion could change",
        ),
        (
            2,
            f"{COLUMN} {AT2} --median --sign both",
            "--median does not go with --sign both",
        ),
        (
            2,
            f"{COLUMN} {AT2} --vertical {AT2.split()[1]}",
            "--vertical goes with one pulse or motion document here",
        ),
        (2, f"{COLUMN} {AT2} --model both", "--model both goes with a pulse"),
    ],
    "fragility": [
        (
            3,
            "--counts more.csv",
            (
                "more.csv, line 3: z: found 14 of n = 10 motions; expected a number"
                " from 0 to n"
            ),
        ),
        (2, f"stated.yaml {LEVELS}", "no set of motions"),
        (2, f"stated.yaml {SITE}", "no --levels"),
        (2, f"stated.yaml {SITE} --levels '0.2 m/s,0.4'", "found '0.2 m/s'"),
        (2, f"stated.yaml {SITE} {LEVELS} --limit -1", "--limit: found '-1'"),
        (2, f"stated.yaml {SITE} {LEVELS} --method ida", "--method: found 'ida'"),
        (2, f"stated.yaml {SITE} {LEVELS} --resume", "--resume goes with -o"),
        (
            2,
            f"stated.yaml {SITE} {LEVELS} --pulse cosine",
            "--pulse does not go with --pulses",
        ),
        (
            2,
            f"stated.yaml {SITE} {LEVELS} --vertical-scale 2",
            "--vertical-scale goes with --vertical",
        ),
        (
            2,
            f"stated.yaml {SITE} {LEVELS} --curve --efficiency",
            "--efficiency and --curve do not go together",
        ),
        (
            2,
            f"stated.yaml {SITE} --levels 0.01g,0.02g,0.03g --limit overturning",
            "stated, overturning, stripes: 0 levels with some",
        ),
        (
            2,
            f"stated.yaml {SITE} {LEVELS} --export pelicun",
            "--export goes with -o FILE",
        ),
        (
            2,
            f"stated.yaml {SITE} {LEVELS} --export pelicun -o f.csv --cells",
            "--cells does not go with --export",
        ),
        (
            2,
            (
                f"stated.yaml {SITE} {LEVELS} --export pelicun -o f.csv --method"
                " stripes,first"
            ),
            "--export goes with one --method",
        ),
        (
            2,
            (
                f"stated.yaml {SITE} {LEVELS} --export openquake -o f.xml --exact"
                " --limit 1"
            ),
            "goes with the limit state overturning",
        ),
        (
            2,
            f"stated.yaml {SITE} {LEVELS} --standing 9yr",
            "--standing goes with --hazard",
        ),
        (2, f"stated.yaml {SITE} {LEVELS} --site 9,45", "--site goes with --hazard"),
        (
            2,
            f"stated.yaml {SITE} {LEVELS} {RATES} --cells",
            "--cells does not go with --hazard",
        ),
        (
            2,
            f"stated.yaml {SITE} {LEVELS} {RATES} --standing 9s",
            "--standing: found '9s'; expected a number of years",
        ),
        (
            2,
            f"stated.yaml {SITE} {LEVELS} {RATES} --standing 0",
            "--standing goes with a positive time",
        ),
        (
            2,
            f"stated.yaml {SITE} {LEVELS} {RATES} --standing 9yr --limit 1",
            "and the limit state overturning",
        ),
        (2, "stated.yaml --counts counts.csv", "FILE does not go with --counts"),
        (3, "--counts short.csv", "short.csv, line 1: found the columns im, n"),
        (3, "--counts x.csv", "x.csv, line 2: z: found 'x'; expected a number"),
    ],
    "params": [
        (2, f"{COLUMN} --json --csv", "--json does not go with --csv"),
        (2, "nothere.yaml", "nothere.yaml: cannot be read"),
        (2, "configs", "configs: found a folder"),
        (3, "empty", "empty"),
        (3, f"{COLUMN} kilograms.yaml", "width: found 2 kg"),
    ],
    "plot": [
        (2, "params.csv -o there.svg", "exists"),
        (2, "params.csv", "no output: give -o FIGURE.png"),
        (2, "params.csv --text", "spectra files"),
        (2, "params.csv --slice A=1 -o x.png", "--slice goes with a spectra file"),
        (2, "SPECTRUM --text --slice Omega=99", "Omega=1 to 8"),
        (2, "SPECTRUM --over height -o x.png", "--over goes with"),
        (
            2,
            "SPECTRUM --all --slice A=3 -o x.png",
            "--all and --slice do not go together",
        ),
        (
            2,
            "SPECTRUM --phase-portrait -o x.png",
            "--phase-portrait goes with CSV, of a response",
        ),
        (2, "SPECTRUM --align -o x.png", "--align goes with CSV, of a response"),
        (
            2,
            "params.csv --phase-portrait -o x.png",
            "cannot be drawn: found no column theta_ratio",
        ),
        (2, "params.csv --animate x.gif", "found no columns t and ground_acceleration"),
        (2, "params.csv --animate x.png", "ends in .gif"),
        (
            2,
            "params.csv --body configs/block.yaml -o x.png",
            "--body goes with --animate",
        ),
        (2, "params.csv params.csv --text", "--text: found 2 files; expected one"),
        (
            2,
            "params.csv -o x.png --size 85",
            "found 85 m; expected a width from 20 mm to 2 m",
        ),
    ],
    "predict": [
        (
            2,
            "SPECTRUM block:1x4,restitution=0.9 --A 9 --Omega 5",
            "is outside the spectrum",
        ),
        (2, "SPECTRUM configs/spire.yaml --A 2 --Omega 5", "the spectrum holds 0.9"),
    ],
    "records": [
        (
            3,
            "column.txt --unit g",
            ("column.txt: numbers without times; give their step as --motion-dt"),
        ),
        (2, "", "no record: give FILE"),
        (3, "empty", "empty: empty"),
        (
            2,
            f"{AT2.split()[1]} --export-spectrum --periods 1e-9:1:3",
            "--periods: found 1e-09 s; expected times from 1.14e-05 s",
        ),
    ],
    "report": [
        (
            2,
            f"configs/parameters.yaml {AT} -o there.html",
            "exists; use --overwrite to replace it",
        ),
        (2, f"configs/parameters.yaml {AT} -o r.pdf", "ends in .html"),
        (2, "configs/parameters.yaml -o r.html", "no shaking"),
    ],
    "response": [
        (
            3,
            f"{COLUMN} --motion header.at2",
            (
                "expected a mapping of keys to values, such as `kind: block`, or a"
                " record of a known format"
            ),
        ),
        (
            2,
            f"{COLUMN} --xlsx",
            "rocking response: No such option --xlsx (did you mean '--csv'?) (see",
        ),
        (
            2,
            f"{COLUMN} --freq 1",
            "rocking response: No such option --freq (did you mean '--f-g'?) (see",
        ),
        # near in letters alone: --release
        (2, f"{COLUMN} --relief 1", "rocking response: No such option --relief (see"),
        (
            2,
            f"{COLUMN} --a-g 0.3 g --f-g 1",
            "--a-g 0.3 g: found a number and its unit in two words; expected one,"
            " --a-g 0.3g or --a-g '0.3 g'",
        ),
        (2, f"{COLUMN} --pga=0.3g --a-g 0.3g --f-g 1", "--a-g is given twice"),
        (
            2,
            f"{COLUMN} -pulse sine",
            (
                "rocking response: No such option -pulse (did you mean '--pulse'?) (see"
                " --help)\n"
            ),
        ),
        (2, f"pair.yaml {AT}", "pair.yaml holds 2 structures; expected one"),
        (2, COLUMN, "no shaking"),
        (2, f"{COLUMN} --a-g 0 --f-g 1", "amplitude is 0"),
        (2, f"{COLUMN} --a-g 1 --f-g 0", "--f-g"),
        (2, f"{COLUMN} --a-g 1", "expected A and Omega"),
        (
            2,
            f"{COLUMN} --a-g 1 --f-g 1:2",
            (
                "--f-g: found '1:2'; expected one value (rocking check and solve take"
                " FROM:TO)"
            ),
        ),
        (2, f"{COLUMN} --release 1", "--release"),
        (2, f"{COLUMN} --release 0.5 --row-step 0", "--row-step"),
        (2, f"{COLUMN} --release 0.5 --row-step 1e-9", "points"),
        (2, f"{COLUMN} --release 0.5 --duration -1", "--duration"),
        (2, f"{COLUMN} {AT} --phase '3 m'", "--phase"),
        (
            2,
            f"{COLUMN} {AT} --motion configs/motions/two_pulses.yaml --pulse sine",
            "--pulse does not go with --motion",
        ),
        (
            2,
            f"{COLUMN} {AT} --vertical-scale 2",
            "--vertical-scale goes with --vertical",
        ),
        (
            3,
            f"{COLUMN} {AT2} --vertical {AT2.split()[1]},unit=gal",
            "`--vertical FILE,unit=`: found gal; the file says otherwise: g",
        ),
        (
            3,
            f"{COLUMN} {AT2} --motion-dt 0.02",
            "--motion-dt: found 0.02 s; the file says otherwise: 0.01 s (PEER AT2)",
        ),
        (
            2,
            f"{COLUMN} {AT2} --column 2",
            "--column goes with plain columns of numbers, not with PEER AT2",
        ),
        (2, f"{COLUMN} {AT} --column 2", "--column goes with a record: give --motion"),
        (
            2,
            f"configs/arch.yaml {AT} --forces --model linear",
            "give --model nonlinear",
        ),
        (
            2,
            f"{COLUMN} {AT2} --azimuth 0:90:3",
            "--azimuth: found 0:90:3; expected one angle",
        ),
        (2, f"{COLUMN} {AT2} --T-g 1", "a record runs in its own time"),
        (
            2,
            f"{COLUMN} --scale-to PGA=1g --a-g 1 --T-g 1",
            "--scale-to goes with a record",
        ),
        (
            2,
            f"{COLUMN} {AT2} --scale-to PGA=1g --a-g 1",
            "--scale-to does not go with an amplitude: expected one of them",
        ),
    ],
    "spectrum": [
        (
            2,
            f"--eta 0.9 {SMALL} --quantity condition,fz_min",
            "quantity fz_min: a sweep no longer stores it; check and response give",
        ),
        (2, "--eta 0.9 -o s.h5", "--grid"),
        (
            2,
            "x.yaml -oa.h5 y.yaml -o a.h5",
            (
                "rocking spectrum: --output is given twice; expected one value (see"
                " --help)\n"
            ),
        ),
        (
            2,
            "--eta block -o s.h5 --grid A=1:2:2,Omega=2",
            "--eta block goes with --alpha",
        ),
        (2, "--eta 0.9 -o s.h5 --grid A=1:2", "START:STOP:N"),
        (
            2,
            f"{COLUMN} -o s.h5 --grid a_g=-1g:1g:5,f_g=1",
            "positive values or zero; --scale -1 gives the motion the other direction",
        ),
        (
            2,
            "--eta 0.9 -o s.h5 --grid A=1:20:30000,Omega=1:20:30000 --cycles 1e5 -q",
            "which would take years; expected up to 5e+08 cells",
        ),
        (
            2,
            "--eta 0.9 -o s.h5 --grid A=1:20:10000,Omega=1:20:10000 --chunk 1 -q",
            "found 100000000 units of work of 1 cells; expected",
        ),
        (2, f"--eta 0.9 {SMALL} --cycles 0.3", "multiple of 0.5"),
        (2, f"--eta 0.9 {SMALL} --shard 4/3", "I/N with I from 1 to N"),
        (2, f"--eta 0.9 {SMALL} --verify-cells 1000000000", "is not in the range"),
        (
            2,
            f"--eta 0.9 {SMALL} --resume --overwrite",
            "rocking: --resume does not go with --overwrite\n",
        ),
        (2, "--eta 0.9 --grid A=1:2:3,Omega=5 -o there.h5", "--overwrite"),
        (2, "--eta 0.9 --grid A=1:2:3,Omega=5 -o configs", "folder"),
        (2, "--eta 0.9 --grid A=1:2:3,Omega=5 -o ''", "found an empty name"),
        (2, f"{COLUMN} --grid A=1:2:3,Omega=5 -o -", "standard output"),
        (
            2,
            "tiny.yaml --grid a_g=1e300:3e300:3,f_g=1:2:2 -o s.h5 -q",
            "range of double precision",
        ),
        (
            2,
            f"{COLUMN} {AT2} --grid a_g=1:2:3,T_g=1 -o x.h5",
            "a record runs in its own time",
        ),
        (
            2,
            f"{AT2} --grid T=1 -o s.h5 --alpha 60deg",
            (
                "alpha 1.0472 rad: eta is -0.125; expected a number from 0 to 1; --eta"
                " gives it another one"
            ),
        ),
        (
            2,
            (
                f"{AT2} --grid T=1 -o s.h5 --alpha 10deg --model linear --linear-uplift"
                " lambda"
            ),
            "--linear-uplift lambda goes with structures",
        ),
    ],
}
# What users typed: the hint on what they mean.
MEANT = [
    (2, f"check stated.yml {AT}", "(did you mean 'stated.yaml'?)"),
    (2, f"check . {AT}", ".: found a folder; expected a file"),
    (2, f"check 0.5x2 {AT}", "(did you mean 'block:0.5x2'?)"),
    (2, "stated.yaml", "; expected one before it: rocking check stated.yaml"),
    (3, f"check tab.yaml {AT}", "found a tab; expected blanks"),
    (3, f"check percent.yaml {AT}", "or auto; did you mean 0.9?"),
    (2, f"check {COLUMN} --a-g 30% --f-g 1", "; did you mean 0.3g?"),
    (2, f"check {COLUMN} --a-g 0.3G --f-g 1", "; did you mean 0.3 g?"),
    (2, f"check {COLUMN} --a-g 0.3g --f-g 1hertz", "; did you mean 1 Hz?"),
    (2, f"check {COLUMN} --a-g 1 --f-g 0.5-5", "; a range is written 0.5:5"),
    (2, f"check {COLUMN} {AT} -f 1", "rocking check: No such option -f (see"),
    (2, f"check {COLUMN} {AT} --model x", "--model; commands with it: response, c"),
    (2, f"check {COLUMN} {AT} --sort capacty", "(did you mean 'capacity'?)"),
    (2, f"check {COLUMN} {AT} --units hz", "(did you mean 'Hz'?)"),
    (2, f"check {COLUMN} {AT} --units inch", "(did you mean 'in'?)"),
    (2, f"check {COLUMN} {AT} -o x.csv", "or the rows by --csv > x.csv"),
    (3, f"check {COLUMN} --motion {COLUMN}", "found a structure, of kind block; exp"),
    (2, f"check {COLUMN} --motion column.txt,units=g", "(did you mean 'unit'?)"),
    (2, "plot stated.yaml -o x.png", "stated.yaml: found a document; expected"),
    (2, f"fragility {COLUMN} {AT2} {LEVELS} --im SA", "such as SA(1.0)"),
]
CALLS = MEANT + [
    (code, f"{command} {line}", words)
    for command, calls in REFUSED.items()
    for code, line, words in calls
]


@pytest.mark.parametrize(
    ("code", "line", "words"),
    CALLS,
    ids=[f"{line[:60]}-{i}" for i, (_, line, _) in enumerate(CALLS)],
)
def test_a_refused_call_is_one_sentence(
    refused, spectrum_file, tmp_path, code, line, words
):
    for name, text in FILES.items():
        (tmp_path / name).write_text(text)
    assert words in refused(
        code, *shlex.split(line.replace("SPECTRUM", str(spectrum_file)))
    )


@pytest.mark.parametrize(
    "command",
    [
        "params",
        "envelope",
        "records",
        "response",
        "compare",
        "predict",
        "accuracy",
        "convert",
        "info",
    ],
)
def test_every_command_with_a_table_takes_units(refused, command):
    assert "--units: found 'x'" in refused(2, command, "--units", "x", "none.yaml")
