"""Which requirement is held by which equation, module, test and case of `rocking
verify`. The tests state it, by markers `requirement(sentence, module, *cases)`; the
package ships what `.ci/requirements.py` reads from them when it is built.
"""

import ast
import json
from collections.abc import Iterator, Mapping
from pathlib import Path

SHIPPED = Path(__file__).with_name("requirements.json")
TESTS = Path(__file__).resolve().parents[2] / "tests"  # of a source tree
_MARKER = "pytest.mark.requirement"


def marked(tests: Path) -> Iterator[dict[str, str]]:
    """Yield requirement, module, test and case of each case that a marker names."""
    for path in sorted(tests.rglob("test_*.py")):
        text = path.read_text(encoding="utf-8")
        for test in ast.parse(text).body if _MARKER in text else ():
            for marker in getattr(test, "decorator_list", ()):
                if not ast.unparse(marker).startswith(_MARKER):
                    continue
                sentence, module, *cases = map(ast.literal_eval, marker.args)
                place = path.relative_to(tests.parent).as_posix()
                row = {"requirement": sentence, "module": module}
                row["test"] = f"{place}::{getattr(test, 'name', '')}"
                yield from (row | {"case": case} for case in cases)


def requirements(equations: Mapping[str, str]) -> list[dict[str, str]]:
    """Return the rows of `rocking verify --trace`; equations: those of the cases."""
    shipped = SHIPPED.exists()
    rows = json.loads(SHIPPED.read_text(encoding="utf-8")) if shipped else marked(TESTS)
    return [
        {
            "requirement": row["requirement"],
            "equation": equations.get(row["case"], ""),
            **{key: row[key] for key in ("module", "test", "case")},
        }
        for row in rows
    ]
