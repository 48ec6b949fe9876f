"""Packages that add to `rocking`, as pip leaves them."""

import sys
from pathlib import Path

import pytest


def installed(
    patch: pytest.MonkeyPatch,
    folder: Path,
    group: str,
    name: str,
    source: str,
    attribute: str = "",
) -> None:
    """Put a package of-NAME on the path: its module rocking_NAME, and the entry point
    `name` in a group, for the module or one of its attributes.
    """
    site = folder / f"site-{name}"
    about = site / f"of_{name}-1.dist-info"
    about.mkdir(parents=True)
    (site / f"rocking_{name}.py").write_text(source)
    (about / "METADATA").write_text(
        f"Metadata-Version: 2.1\nName: of-{name}\nVersion: 1\n"
    )
    place = f"rocking_{name}:{attribute}" if attribute else f"rocking_{name}"
    (about / "entry_points.txt").write_text(f"[{group}]\n{name} = {place}\n")
    patch.syspath_prepend(str(site))
    patch.delitem(sys.modules, f"rocking_{name}", raising=False)
