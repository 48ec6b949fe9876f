"""Documents that are refused: the place, the key, the value found and the values
expected; restraints and insets of all kinds too.
"""

from support.documents import built
from support.refusals import refuses

from rocking_cli import DocumentError

REFUSED = {
    "kind: arch\nradius: 10\nthickness: 1.5\nangle: 157.5 deg\n": [
        ("voussoirs: 3", "found 3; expected a whole number from 4"),
        ("voussoirs: 7.5", "found 7.5; expected a whole number from 4"),
        ("hinges: [0, 1]", "found a list; expected four angles"),
        ("hinges: 3", "found 3; expected four angles"),
        ("hinges: [0, 2, 1, 2.7]", "angles out of order"),
        ("hinges: [0, 1, 2, 3]", "beyond the springings"),
        ("hinges: [0, 1 kg, 2, 2.7]", "found 1 kg; expected four angles"),
        (
            "hinges: [{angle: 0, face: intrados}, {angle: 1, face: intrados}, 2, 2.7]",
            "faces that do not alternate",
        ),
        (
            "hinges: [{angle: 0, fac: intrados}, 1, 2, 2.7]",
            "unknown key 'fac' .did you mean 'face'",
        ),
        ("voussoirs: 7\nhinges: [0, 1, 2, 2.7]", "between two joints"),
        ("hinges: [0, 0.1, 0.2, 0.3]", "do not open on their far faces"),
    ],
    "kind: arch\nthickness: 0.5\n": [
        ("span: 8", "no key 'rise'; expected rise: a length"),
        (
            "radius: 5\nrise: 2",
            "rise: found rise together with radius; expected radius and angle, or span",
        ),
        (
            "span: 8\nrise: 3\nangle: 2",
            "span: found span together with angle; expected radius and angle, or span",
        ),
        ("", "no key 'radius'; expected radius: a length"),
        (
            "span: 8\nrise: 3\nmeasured: crown",
            "measured: found crown; expected one of centre-line, intrados, extrados",
        ),
    ],
    "kind: arch\n": [
        (
            "radius: 10\nthickness: 1\nangle: 180 deg",
            "thickness: found 1: the arch cannot carry its own weight",
        ),
        (
            "radius: 10\nthickness: 1.5\nangle: 360 deg",
            "found 360 deg; expected an angle between 0 and 360 deg",
        ),
        (
            "radius: 10\nthickness: 20\nangle: 90 deg",
            "found 20; expected a length between 1e-09 m and 20 m",
        ),
        (
            (
                "radius: 10\nthickness: 1\nangle: 180 deg\nhinges: [0, 40 deg, 120 deg,"
                " 180 deg]"
            ),
            "cannot carry its own weight",
        ),
        (
            "radius: 1\nthickness: 0.82\nangle: 222 deg\nvoussoirs: 5",
            "no linkage of four hinges that governs",
        ),
        (
            "radius: 10\nthickness: 1.5\nangle: 157.5",
            (
                "found 157.5; expected an angle between 0 and 360 deg .a bare number is"
                " in rad"
            ),
        ),
        (
            "radius: 1\nthickness: 1.62\nangle: 303.2 deg\nvoussoirs: 16",
            "cannot carry its own weight",
        ),
        (
            "radius: 5\nangle: 2\nthickness: 5\nmeasured: extrados",
            "thickness: found 5; expected a length between 1e-09 m and 5 m",
        ),
        ("radius: 1e200\nthickness: 1\nangle: 1\nvoussoirs: 12", "radius: found 1e200"),
        (
            "one_sided: true\nradius: 10\nthickness: 1.5\nangle: 3",
            "one_sided: found true; expected false: an arch sways to both sides",
        ),
    ],
    "kind: drum\n": [
        ("radius: 1\nheight: 6\ntop_radius: 1", "top_radius together with radius"),
        ("drums: []", "expected a list of drums"),
        ("drums: [3]", "found 3; expected a mapping"),
        ("drums: [{radius: 1, heigth: 2}]", "unknown key 'heigth'"),
        (
            "radius: 1\nheight: 6\noffset: 1",
            "offset: found 1; expected a length between -1 and 1 m, above its base",
        ),
        ("base_radius: 1\ntop_radius: -1\nheight: 3", "top_radius: found -1"),
    ],
    "kind: frame\n": [
        (
            "columns: 0\nwidth: 1\nheight: 6\ncap_ratio: 1",
            "columns: found 0; expected a whole number from 1",
        ),
        ("columns: 2\nwidth: 1\nheight: 6\ncap_ratio: -1", "cap_ratio: found -1"),
        (
            "one_sided: true\ncolumns: 4\nwidth: 1\nheight: 5\ncap_ratio: 1",
            "does not define its impact on the backing",
        ),
    ],
    "kind: prism\n": [
        ("corners: [[0, 0], [1, 0]]", "found a list; expected a list of three or more"),
        ("corners: [[0, 0], [2, 2], [2, 0], [0, 2]]", "crosses itself"),
        ("corners: [[0, 0], [2, 0], [1, 0], [1, 3]]", "crosses itself"),
        ("corners: [[0, 0], [1, 4], [-1, 4]]", "rests on one point"),
        (
            "corners: [[0, 0], [1, 0], [9, 5], [8, 5]]",
            "centroid that is not above the base",
        ),
        ("corners: [[0, 0], [1, 0], [2, 0]]", "without area|crosses itself"),
        ("corners: [[0, 0], [1, 0], [1, 3], [1, 0]]", "given twice"),
        ("corners: [[0, 0], [1, 0], [1, 3, 4]]", "not a pair of lengths .line 2"),
        ("corners: [[0, 0], [1, 0], [1, 3 kg]]", "not a pair of lengths"),
        ("corners: [[0, 0], [1e200, 0], [0, 1]]", "corners: found a corner"),
    ],
    "kind: rigid\nleft: 0.42\nright: 31 cm\nheight: 1.15\n": [
        ("", "no key 'gyration'; expected gyration: a length"),
        ("gyration: 0", "gyration: found 0; expected a positive length"),
        (
            "gyration: 1\ninertia: 3",
            (
                "inertia: found inertia together with gyration; expected gyration, or"
                " inertia and mass"
            ),
        ),
        (
            "inertia: 3",
            "no key 'mass'; expected mass: the mass .kg. that goes with inertia",
        ),
        ("inertia: 3 kg\nmass: 2", "inertia: found 3 kg; expected a moment of inertia"),
        ("gyration: 1\nmass: -2", "mass: found -2; expected a positive mass"),
    ],
    "kind: rigid\n": [
        (
            "left: 1e9\nright: 0.3\nheight: 0.4\ngyration: 1",
            "left: found 1e.09 m; expected up to 1000 times the 0.5 m from",
        ),
        (
            "left: 0.42\nright: -1\nheight: 1.15\n",
            "right: found -1; expected a positive length",
        ),
        (
            "left: 0.42\nright: 31 cm\nheight: 0.2\ngyration: 0.2",
            "gives the restitution -.*, below 0; expected a body more slender",
        ),
        (
            "one_sided: true\nleft: 1\nright: 1\nheight: 3\ngyration: 1",
            "does not define its impact on the backing",
        ),
    ],
    "kind: spire\nbase_radius: 1.5\nheight: 12\n": [
        (
            "thickness: 1.5",
            "thickness: found 1.5; expected a positive length below base_radius",
        ),
        (
            "thickness: 0.15\ncrack: diagonal\ncrack_height: 11",
            "crack_height: found 11; expected a length from 0 .the base. to 10.8 m",
        ),
        ("thickness: 0.15\ncrack: diagonal\ntip_height: 13", "tip_height: found 13"),
        ("crack: diagonal", "a crack up to the apex"),
        ("thickness: 0.15\ncrack: diagonal\ntip_height: 12", "a crack up to the apex"),
        ("tip_height: 9", "solid tip on a thin wall"),
        ("crack: none\ncrack_height: 3", "only together with crack: diagonal"),
        ("crack: vertical", "found vertical; expected one of none, diagonal"),
    ],
    "kind: spire\n": [
        (
            "base_radius: 1e9\nheight: 1e9\nthickness: 1e-9",
            r"thickness: found 1e-9; .* below base_radius \(1e\+09 m\) and above 1 m",
        ),
        (
            (
                "one_sided: true\nbase_radius: 1.5\nheight: 12\nthickness: 0.15\ncrack:"
                " diagonal"
            ),
            "does not define its impact on the backing",
        ),
    ],
    "kind: stack\n": [
        ("pieces: []", "pieces: found a list; expected a list of pieces, each with"),
        (
            "pieces: [{width: 1, radius: 1, height: 2}]",
            "radius: found radius together with width; expected width and height",
        ),
        (
            "pieces: [{width: 1, heigth: 2}]",
            "f.yaml:2:29: unknown key 'heigth' .did you mean 'height'",
        ),
        (
            "pieces: [{width: 1, height: 2, density: 1}, {width: 1, height: 2}]",
            "density for every piece, or for none",
        ),
        (
            "pieces: [{width: 1, height: 2}, {width: 1, height: 2, offset: 1}]",
            "piece 2 from below apart from the one",
        ),
        (
            "pieces: [{width: 1, height: 2}, {width: 1, height: 2, offset: 0.7}]",
            "piece 2 from below, with the pieces on it",
        ),
    ],
    "kind: parameters\np: 2\nalpha: 0.2\nlambda: 0.2\none_sided: true\n": [
        (
            "eta: 0.4",
            "f.yaml:6:6: eta: found 0.4; expected a number above -1 and up to 0",
        ),
        (
            "eta: -0.4\ndamping: 1",
            "damping: found 1; expected a number from 0 to below 1",
        ),
        (
            "eta: -0.4\nstructure_kind: dimensionless",
            "structure_kind: found dimensionless; expected the kind of a structure",
        ),
    ],
    "kind: parameters\nsides:\n"
    "- {side: left, p: 2, alpha: 0.2, lambda: 0.2, eta: 0.9}\n": [
        ("", "sides: found a list; expected a list of two"),
        (
            "- {side: left, p: 2, alpha: 0.3, a_scale: 1, eta: 0.8}\n",
            "sides: found the left side twice",
        ),
        (
            "- {side: rigth, p: 2, alpha: 0.3, a_scale: 1, eta: 0.8}\n",
            "side: found rigth; expected one of left, right",
        ),
        (
            "- {side: right, p: 2, alpha: 0.3, a_scale: 1, ata: 0.8}\n",
            "did you mean 'eta'",
        ),
        (
            "- {side: right, p: 2, alpha: 0.3, a_scale: 1, eta: 0.8}\nalpha: 0.3",
            "expected 0.2 as in sides, where the left edge lifts",
        ),
        (
            "- {side: right, p: 2, alpha: 0.3, a_scale: 1, eta: 0.8}\none_sided: true",
            "one_sided: found a one-sided body of two sides",
        ),
    ],
    "kind: parameters\np: 2\nalpha: 0.2\neta: 0.9\nlambda: 0.2\n": [
        (
            "arm: 2.5",
            r"arm: found 2.5; expected a positive length up to g/p\^2, 2.4525 m",
        ),
        *(
            (more, "expected numbers by key")
            for more in ("varied: 3", "varied: {width: x}", "varied_units: {width: m}")
        ),
        ("varied: {width: 1}\nvaried_units: [m]", "expected numbers by key"),
    ],
    "kind: parameters\n": [
        (
            "p: 2\nalpha: 0.2\nlambda: 0.2\none_sided: yes\neta: -0.4",
            "one_sided: found yes; expected true or false",
        ),
        (
            "p: 1e200\nalpha: 0.2\nlambda: 0.2\neta: 0.4",
            "f.yaml:2:4: p: found 1e200; expected a positive number, from 1e-150 to",
        ),
        ("p: 1\nalpha: 1e-300\neta: 1\nlambda: 1e300", "a_scale is 0"),
        (
            "p: 1\nalpha: 1e-90\neta: 1\nlambda: 1e-90",
            "alpha is 1e-90 rad; expected 1e-30 rad or more",
        ),
    ],
    "kind: block\none_sided: true\n": [
        (
            "width: 1\nheight: 5\nrestitution: 0.4",
            "restitution: found 0.4; expected a number above -1 and up to 0",
        ),
        (
            "width: 4\nheight: 5",
            (
                r"one_sided: found a restitution of 0\.\d+ from three impacts, .* more"
                r" slender"
            ),
        ),
        (
            "width: 3\nheight: 2",
            r"found width 3 m and height 2 m, wider than high .did you swap",
        ),
    ],
    "kind: block\n": [
        (
            "width: 1e-300\nheight: 1",
            "width: found 1e-300; expected a positive length, from 1e-09 m",
        ),
        ("width: 1e7 km\nheight: 1", r"up to 1e\+09 m"),
        (
            "width: 1\nheight: 4\neta: 0.9",
            "unknown key 'eta' .did you mean 'restitution'",
        ),
        (
            "width: 1\nheight: 4\nfriction: 0",
            r"friction: found 0; expected a positive number .a coefficient of friction",
        ),
        ("width: 1\nheight: 4\nfriction: 5 m", "friction: found 5 m; expected a"),
    ],
    "kind: wall\nthickness: 0.6 m\nheight: 6 m\none_sided: true\n"
    "mass: 7200 kg\nties:\n- ": [
        (
            "{height: 6.5, stiffness: 1}",
            (
                r"f.yaml:7:12: height: found 6.5; expected a height above the ground,"
                r" and up to 6 m, the top"
            ),
        ),
        (
            "{height: 5, stiffness: -1}",
            r"f.yaml:7:26: stiffness: found -1; expected a stiffness from 0",
        ),
        ("{height: 5}", "no key 'stiffness'"),
        (
            "{height: 5, stiffness: 1, prestress: 5 kN, yield: 4 kN}",
            r"f.yaml:7:40: prestress: found 5000 N, not below the yield of 4000 N",
        ),
        (
            "{height: 5, stiffness: 1, yield: 0}",
            r"yield: found 0; expected a positive force",
        ),
        (
            (
                "{height: 5, stiffness: 1e6, prestress: 5 kN, yield: 20 kN, ultimate:"
                " 14 mm}"
            ),
            "ultimate: found 0.014 m, below the elongation",
        ),
        (
            "{height: 5, stiffness: 1, ultimate: 30}",
            "ultimate: found 30; expected .* up to 5 m, which the body can reach",
        ),
        (
            "{height: 5, stiffness: 1e30}",
            "ties: found ties that add 1.17e.26 m g R .*; expected up to 1e.09 m g R",
        ),
        (
            "{height: 5, stiffness: 1}\nfriction: 0.6",
            (
                "friction: found friction of a body with ties, whose sliding is"
                " not computed"
            ),
        ),
        (
            "{height: 5,5 m, stiffness: 1}",
            (
                "f.yaml:7:14: height: found 5,5 m; expected a number; write 5.5 m with"
                " a decimal point"
            ),
        ),
        (
            "{height: 5, stiffness: 1, side: left}",
            (
                "side: found left on a one-sided body, which never leans there;"
                " expected right"
            ),
        ),
        (
            "{height: 5, stiffness: 1, side: up}",
            "side: found up; expected one of left, right, both",
        ),
        (
            "{height: 5, stiffness: 1, behind: 0.7}",
            "behind: found 0.7; expected a length from 0 to 0.6 m",
        ),
        (
            "{height: 5, stiffness: 1, area: 3 mm2}",
            "area: found area together with stiffness",
        ),
        ("{height: 5, area: 3 mm2, length: 2 m}", "no key 'modulus'"),
        (
            "{height: 5, stiffnes: 1}",
            "unknown key 'stiffnes' .did you mean 'stiffness'",
        ),
    ],
    "kind: block\nwidth: 1\nheight: 5\n": [
        (
            "ties: [{height: 1, stiffness: 1}]",
            "no key 'mass'; expected mass: the mass .kg., which ties need",
        ),
        (
            "mass: 9\ntendon: {stiffness: 1, prestress: 6 kN, rupture: 5 kN}",
            ":5:50: rupture: found 5000 N, not above the prestress of 6",
        ),
        ("mass: 9\ntendon: 3", "tendon: found 3; expected a mapping"),
        ("mass: 9\nties: []", "ties: found a list; expected a list of ties"),
        ("mass: 9\nties:", "ties: found nothing; expected the ties, or no such key"),
        (
            "mass: 9\ndampers: {coefficient: 1e9}",
            r"f.yaml:5:10: dampers: found dampers of zeta = .*; expected zeta below 1",
        ),
        (
            "mass: 9\ndampers: {coefficient: 1 kg}",
            "coefficient: found 1 kg; expected a damping coefficient",
        ),
        (
            "inset: 0.5",
            r"f.yaml:4:8: inset: found 0.5; expected a length from 0 to below 0.5 m",
        ),
        ("inset: 5 deg", "inset: found 5 deg; expected a length"),
    ],
    "kind: stack\npieces: [{width: 2, height: 2}, {width: 1, height: 2}]\nmass: 1\n": [
        (
            "ties: [{height: 3, stiffness: 1}]",
            (
                "no key 'rocks_on'; expected .*: ties hold each interface differently,"
                " so check each one"
            ),
        ),
        (
            "rocks_on: 2",
            "f.yaml:4:11: rocks_on: found 2; expected a whole number from 0 to 1",
        ),
    ],
    "kind: frame\ncolumns: 4\nwidth: 0.5\nheight: 4\ncap_ratio: 1.5\nmass: 5 t\n": [
        (
            "ties: [{height: 4.2, stiffness: 1e5}]",
            "height: found 4.2; expected .* up to 4 m, the top of the body",
        )
    ],
    "kind: arch\nradius: 10\nthickness: 1.5\nangle: 3\n": [
        (
            "ties: [{height: 1, stiffness: 1}]",
            r"f.yaml:5:7: ties: found ties of kind arch; expected no ties",
        ),
        (
            "inset: 1 cm",
            r"f.yaml:5:8: inset: found inset of kind arch; expected no inset",
        ),
    ],
    "kind: parameters\np: 1\nalpha: 0.2\neta: 1\nlambda: 0.2\n": [
        (
            "mass: 1\nties: [{height: 1, stiffness: 1}]",
            "ties: found ties of a body whose arm is not known; expected arm as well",
        ),
        (
            (
                "mass: 1\narm: 1\nties: [{height: 1, stiffness: 1}]\ndampers:"
                " {coefficient: 1}"
            ),
            "dampers of a body whose width is not known",
        ),
        ("inset: 0.1", r"f.yaml:6:8: inset: found inset of kind parameters"),
    ],
    "kind: rigid\nleft: 0.42\nright: 0.3\nheight: 1.15\ngyration: 0.68\nmass: 1 t\n": [
        (
            "tendon: {stiffness: 1}",
            "tendon: found tendon of a body with two unequal sides",
        ),
        ("inset: 0.3", "inset: found 0.3; expected a length from 0 to below 0.3 m"),
    ],
    "kind: stack\ninset: 0.2\npieces: [{width: 1, height: 6}, ": [
        (
            "{width: 0.2, height: 0.1}]",
            "inset: found an inset beyond half the base of piece 2",
        ),
        (
            "{width: 0.4, height: 0.1, offset: 0.1}]",
            "inset: found piece 2 from below, with the pieces on it, beyond its edge",
        ),
    ],
    "": [
        (
            "kind: spire\nbase_radius: 1\nheight: 9\ncrack_height: 3\ninset: 0.1",
            "inset: found an inset of a cracked spire",
        ),
        (
            (
                "kind: frame\ncolumns: 2\nwidth: 1\nheight: 6\ncap_ratio: 1\nmass:"
                " 1\ntendon: {stiffness: 1}"
            ),
            "a body with other parts",
        ),
        ("kind: prism", "no key 'corners'"),
        (
            "kind: stack",
            "no key 'pieces'; expected pieces: a list of pieces, each with",
        ),
        (
            "kind: point_mass\none_sided: true\nwidth: 1\nheight: 5",
            "its impact on the backing; expected restitution as well",
        ),
    ],
}
test_refusals = refuses(
    built,
    DocumentError,
    [
        (common + text, words)
        for common, rows in REFUSED.items()
        for text, words in rows
    ],
)
