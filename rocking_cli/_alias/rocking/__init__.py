"""`rocking`: the package `rocking_cli` by the name of the program.

`import rocking` gives the package `rocking_cli` itself, and `import rocking.motions`
its module `rocking_cli.motions`: no module is loaded twice.
"""

import sys
from collections.abc import Sequence
from importlib import import_module
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType

_ALIAS, _PACKAGE = "rocking", "rocking_cli"


class _SameModule(MetaPathFinder, Loader):
    """Finds the modules below `rocking` as those below `rocking_cli`."""

    def find_spec(
        self,
        fullname: str,
        path: Sequence[str] | None,
        target: ModuleType | None = None,
    ) -> ModuleSpec | None:
        begin, _, rest = fullname.partition(".")
        if begin != _ALIAS or rest in ("", "__main__"):  # python -m rocking runs a file
            return None
        return ModuleSpec(fullname, self)

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        module = import_module(_PACKAGE + spec.name.removeprefix(_ALIAS))
        spec.loader_state = module.__spec__  # the import system replaces it
        return module

    def exec_module(self, module: ModuleType) -> None:
        assert module.__spec__ is not None
        module.__spec__ = module.__spec__.loader_state


sys.meta_path.insert(0, _SameModule())
sys.modules[_ALIAS] = import_module(_PACKAGE)
