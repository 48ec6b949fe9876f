"""What stands on the shelf beside the program agrees with it: citation, tests on
other systems, the description of the package.
"""

import re
import tomllib

import pytest
import yaml

import rocking_cli


@pytest.fixture(scope="module")
def project(pytestconfig):
    text = (pytestconfig.rootpath / "pyproject.toml").read_text(encoding="utf-8")
    return tomllib.loads(text)["project"]


def test_the_citation_is_of_this_version_and_of_the_paper(pytestconfig):
    file = pytestconfig.rootpath / ".github" / "CITATION.cff"
    found = yaml.safe_load(file.read_text(encoding="utf-8"))
    assert found["version"] == rocking_cli.__version__
    readme = (pytestconfig.rootpath / "README.md").read_text(encoding="utf-8")
    paper = found["preferred-citation"]
    assert f"*{paper['title']}*" in readme
    for author in paper["authors"]:
        assert f"{author['given-names']} {author['family-names']}" in readme


def test_the_tests_run_on_three_systems_with_the_lowest_and_the_newest_python(
    pytestconfig, project
):
    file = pytestconfig.rootpath / ".github" / "workflows" / "test.yml"
    job = yaml.safe_load(file.read_text())["jobs"]["test"]
    matrix = job["strategy"]["matrix"]
    systems = {name.partition("-")[0] for name in matrix["os"]}
    assert systems == {"ubuntu", "macos", "windows"}
    lowest = re.fullmatch(r">=(3\.\d+)", project["requires-python"])[1]
    assert matrix["python"] == [lowest, "3.x"]
    used = [step["uses"] for step in job["steps"] if "uses" in step]
    assert used
    for action in used:  # its owner can move a tag, but not a commit
        assert re.fullmatch(r"[\w/-]+@[0-9a-f]{40}", action)


def test_the_package_says_what_it_is_for(project):
    assert {"rocking", "masonry"} <= set(project["keywords"])
    assert "Typing :: Typed" in project["classifiers"]
    assert set(project["optional-dependencies"]) >= {"docs", "plot", "report", "dev"}


def test_a_room_imports_only_from_the_rooms_that_contributing_lists_above_it(
    pytestconfig,
):
    text = (pytestconfig.rootpath / ".github" / "CONTRIBUTING.md").read_text("utf-8")
    rooms = re.findall(r"^- `(?:rocking_cli/)?([a-z]+)/`:", text, re.MULTILINE)
    package = pytestconfig.rootpath / "rocking_cli"
    assert set(rooms) == {
        file.parent.name for file in package.glob("[a-z]*/__init__.py")
    }
    for file in package.glob("*/**/*.py"):
        room, *inside = file.relative_to(package).parts
        upwards = "." * (len(inside) + 1)
        later = rooms[rooms.index(room) + 1 :] if room in rooms else []
        for line in file.read_text(encoding="utf-8").splitlines():
            found = re.match(rf"\s*from {re.escape(upwards)}([a-z]+)", line)
            assert not (found and found[1] in later), f"{file}: {line.strip()}"
