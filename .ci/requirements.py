"""Adds the table of requirements to a wheel, read from the markers at the tests."""

import importlib.util
import json
import tempfile
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

READER = "rocking_cli/commands/requirements.py"  # it imports no other package


class Requirements(BuildHookInterface):
    """Writes the table while the wheel is built."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        if version == "editable":  # a source tree reads its tests
            return
        root = Path(self.root)
        spec = importlib.util.spec_from_file_location("requirements", root / READER)
        reader = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(reader)
        rows = list(reader.marked(root / "tests"))
        folder = Path(tempfile.mkdtemp())
        made = folder / reader.SHIPPED.name
        made.write_text(json.dumps(rows, indent=1), encoding="utf-8")
        build_data["force_include"][str(made)] = f"rocking_cli/commands/{made.name}"
