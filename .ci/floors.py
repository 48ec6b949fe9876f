"""The lowest versions of the run-time packages that pyproject.toml allows, as
constraints for pip: `NAME==FLOOR`, one a line.
"""

import re
import tomllib
from pathlib import Path

root = Path(__file__).resolve().parent.parent
stated = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))
for requirement in stated["project"]["dependencies"]:
    name, floor = re.fullmatch(r"([A-Za-z0-9-]+)>=([0-9.]+)", requirement).groups()
    print(f"{name}=={floor}")
