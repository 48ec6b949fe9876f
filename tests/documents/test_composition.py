"""Text to nodes: bounds that cost nothing, and a line for every refusal, whatever was
written.
"""

import random
import re

import pytest
from support.refusals import refuses

from rocking_cli import DocumentError, build_structure, parse_documents
from rocking_cli.documents import files, nodes
from rocking_cli.motions.motion_document import build_motion
from rocking_cli.structures import read_documents

BLOCK = "kind: block\nwidth: 1\nheight: 5\n"
REFUSED = [
    (b"", "1:1: empty"),
    (b"# nothing\n", "1:1: empty"),
    (b"kind: block\nname: S\xe4\x81ule\n", r"2:8: not a UTF-8 text \(byte 19\)"),
    (b"\xef\xbb\xbfkind: block\nname: S\xe4ule\n", r"2:8: not a UTF-8 text"),
    ("name: Säule".encode() + b"\n\xff\n", r"2:1: not a UTF-8 text"),
    ("kind: block".encode("utf-16") + b"\n", r"1:12: not a UTF-8 text"),
    (
        b"kind: block\nname: a\x1b[31m\n",
        "2:8: not valid YAML: holds the control character U\\+001B",
    ),
    (
        b'{"kind": "block"}\n\n{"kind":\n "a\x7f"}',
        "4:4: not valid YAML: holds the control character U\\+007F",
    ),
    (b"a: " + b"[" * 100, "1:23: nested too deeply"),
    (b'{"a": ' + b"[" * 100_000 + b"]" * 100_000 + b"}", "1:26: nested too deeply"),
    (b'{"a": 1}\n{"a": 2}\n{"a" 3}', "3:6: not valid JSON"),
]
ROWS = [(raw, rf"f\.yaml:{words}") for raw, words in REFUSED]
test_every_fault_of_a_text_has_its_place = refuses(
    read_documents, DocumentError, ROWS, file="f.yaml"
)


def test_a_file_beyond_the_limit_is_not_composed(tmp_path, monkeypatch):
    monkeypatch.setattr(nodes, "_Composer", None)  # would fail
    path = tmp_path / "f.yaml"
    path.write_text("# a comment\n" * 200_000)
    with pytest.raises(
        DocumentError,
        match=(
            r"f\.yaml:174763:9: longer than 2 MiB, the limit of a structure document$"
        ),
    ):
        read_documents(path)
    monkeypatch.setattr(files, "LARGEST", 1 << 20)
    with pytest.raises(DocumentError, match=r"f\.yaml: larger than 1 MiB"):
        read_documents(path)


def test_composing_stops_at_the_limit_of_values(monkeypatch):
    monkeypatch.setattr(nodes, "MOST_VALUES", 20)
    text = (
        "points:\n" + "".join(f"- [{i}, 0]\n" for i in range(1000)) + "- }"
    )  # what follows is not composed
    with pytest.raises(
        DocumentError, match=r"f:8:7: too many values to be a structure document$"
    ):
        parse_documents(text, "f")


def test_the_limit_of_values_is_that_of_one_document(monkeypatch):
    monkeypatch.setattr(nodes, "MOST_VALUES", 8)
    assert len(parse_documents("---\n".join([BLOCK] * 5))) == 5


def test_a_long_stream_of_json_objects_is_read(monkeypatch):
    monkeypatch.setattr(nodes, "LONGEST", 60)  # of each, not of the stream
    documents = parse_documents(
        '{"kind": "block", "width": 1, "height": 5}\n\n' * 200, "f"
    )
    assert [d.place.line for d in documents] == list(range(1, 400, 2))


CHARACTERS = list(
    " \n\t:-#'\"{}[]&*!|>%@`,?\\~\0\x1b"
    "0123456789.eE+-²½αabcxyz<\ufeff\x85\u2028\U0001f5fc"
)
WORDS = [
    "1e400",
    "-1",
    "0",
    "1e-300",
    "nan",
    ".inf",
    "null",
    "~",
    "true",
    "auto",
    "[1]",
    "{a: b}",
    "''",
    "010",
    "1:30",
    "2 kg",
    "90 deg",
]
WORDS += [
    "1 m",
    "|",
    "&x a",
    "*a",
    "!!int 3",
    "<<",
    "---",
    "...",
    "%YAML 1.1",
    "diagonal",
    "parameters",
    "arch",
    "spire",
]


def mutated(raw: bytes, rng: random.Random) -> bytes:
    """One to three slips of the hand, or of a disk: a character, a word, a line or a
    byte that is wrong, missing or doubled.
    """
    text = raw.decode()
    for _ in range(rng.choice([1, 1, 1, 2, 3])):
        at, lines = rng.randrange(len(text) + 1), text.splitlines() or [""]
        line = rng.randrange(len(lines))
        match rng.randrange(6):
            case 0:
                text = (
                    text[:at] + rng.choice(CHARACTERS) + text[at + rng.randrange(2) :]
                )
            case 1:
                text = text[:at] + text[at + rng.choice([1, 2, 5, 20]) :]
            case 2:
                text = "\n".join(
                    [
                        *lines[:line],
                        lines[rng.randrange(len(lines))],
                        *lines[line + rng.randrange(2) :],
                    ]
                )
            case 3:
                text = "\n".join(
                    [
                        *lines[:line],
                        f"{lines[line].partition(':')[0]}: {rng.choice(WORDS)}",
                        *lines[line + 1 :],
                    ]
                )
            case 4:
                text = re.sub(
                    r"\d+(\.\d+)?",
                    lambda m: rng.choice([rng.choice(WORDS), m[0]]),
                    text,
                    count=rng.randrange(1, 4),
                )
            case _:
                text = text[:at] + rng.choice(WORDS) + text[at:]
    if rng.randrange(5) == 0:
        at = rng.randrange(len(raw) + 1)
        return raw[:at] + bytes([rng.randrange(256)]) + raw[at:]
    return text.encode()


@pytest.mark.parametrize(
    "seed", [0, 1, 2, *(pytest.param(s, marks=pytest.mark.soak) for s in range(3, 8))]
)
def test_every_refusal_of_a_mutated_document_names_a_line(seed, tmp_path, pytestconfig):
    configs = pytestconfig.rootpath / "configs"
    builders = [(p, build_structure) for p in sorted(configs.glob("*.yaml"))]
    builders += [
        (p, build_motion) for p in sorted((configs / "motions").glob("*.yaml"))
    ]
    rng, refusals = random.Random(seed), []
    path = tmp_path / "f.yaml"
    for original, build in (rng.choice(builders) for _ in range(60)):
        path.write_bytes(mutated(original.read_bytes(), rng))
        try:
            for document in read_documents(path):
                build(document)
        except DocumentError as error:
            refusals.append(str(error))
    assert len(refusals) > 20
    assert [
        r
        for r in refusals
        if not re.fullmatch(rf"{re.escape(str(path))}:[1-9]\d*:[1-9]\d*: .+", r)
    ] == []
