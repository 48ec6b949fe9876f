"""Commands that a text shows, run as a reader would run them.

`python tests/support/shown_commands.py` writes what they print into the README and the
help pages.
"""

import re
import shlex
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
README = ROOT / "README.md"
PAGES = ROOT / "rocking_cli" / "commands" / "pages"
# a command of a help page and its output, which is indented further
SHOWN = re.compile(
    r"^    (rocking .*)\n(?:\n((?:      .*\n|\n(?=      ))+))?", re.MULTILINE
)
BLOCK = re.compile(
    r"```yaml\n# (?P<name>\S+)\n(?P<document>.*?)```"
    r"|```sh\n(?P<commands>.*?)```(?:\n\n```\n(?P<output>.*?)```)?",
    re.DOTALL,
)
Run = Callable[..., subprocess.CompletedProcess[str]]


def lines(commands: str) -> list[str]:
    """The commands of a block, those that go on after a backslash put together."""
    return [line for line in re.sub(r"\\\n\s*", "", commands).splitlines() if line]


def shell(rocking: Run, line: str, folder: Path) -> str:
    """What a line prints, pipes into `rocking` and `head` and redirections included; it
    must succeed, and say or write something.
    """
    line, _, target = line.partition(" > ")
    said, out = "", ""
    before = set(folder.iterdir())
    for stage in line.split(" | "):
        name, *arguments = shlex.split(stage)
        if name == "head":
            assert arguments[0] == "-n"
            out = "".join(out.splitlines(keepends=True)[: int(arguments[1])])
            continue
        assert name == "rocking", stage
        done = rocking(*arguments, stdin=out)
        assert done.returncode == 0, f"{stage}\n{done.stderr}"
        out, said = done.stdout, said + done.stderr
    if target:
        (folder / target).write_text(out, encoding="utf-8")
    assert out or said or set(folder.iterdir()) > before, line
    return "" if target else out


def written(text: str, rocking: Run, folder: Path) -> str:
    """The Markdown text with the output of its commands as they print it, run from the
    top in one folder with its documents.
    """

    def block(found: re.Match[str]) -> str:
        if found["name"]:
            (folder / found["name"]).write_text(found["document"], encoding="utf-8")
            return found[0]
        printed = "".join(
            shell(rocking, line, folder) for line in lines(found["commands"])
        )
        if found["output"] is None:
            return found[0]
        visible = "".join(f"{line.rstrip()}\n" for line in printed.splitlines())
        return f"```sh\n{found['commands']}```\n\n```\n{visible}```"

    return BLOCK.sub(block, text)


def page_written(text: str, rocking: Run, folder: Path) -> str:
    """The help page with the output of its commands that show one as they print it;
    files that these read are written before.
    """
    showing = " ".join(line for line, shown in SHOWN.findall(text) if shown)

    def output(found: re.Match[str]) -> str:
        line = found[1]
        _, _, target = line.partition(" > ")
        if not found[2] and not (target and target in showing):
            return found[0]
        printed = shell(rocking, line, folder).splitlines()
        if not found[2]:  # it writes a file that a later command reads
            return found[0]
        shown = "".join(f"      {one}".rstrip() + "\n" for one in printed)
        return f"    {line}\n\n{shown}"

    return SHOWN.sub(output, text)


def in_folder(folder: Path) -> Run:
    """`rocking` as a program of its own, in a folder with `configs`."""
    if not (folder / "configs").exists():
        (folder / "configs").symlink_to(ROOT / "configs")

    def rocking(*arguments: str, stdin: str = "") -> subprocess.CompletedProcess[str]:
        call = [sys.executable, "-m", "rocking_cli", *arguments]
        return subprocess.run(
            call, input=stdin, capture_output=True, text=True, check=False, cwd=folder
        )

    return rocking


def main() -> None:
    import tempfile

    from bench.speed import in_readme

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        rocking = in_folder(folder)
        for page in PAGES.glob("*.txt"):
            page.write_text(
                page_written(page.read_text(encoding="utf-8"), rocking, folder),
                encoding="utf-8",
            )
        README.write_text(
            in_readme(written(README.read_text(encoding="utf-8"), rocking, folder)),
            encoding="utf-8",
        )


if __name__ == "__main__":
    main()
