"""Functions that a spec names: code, which runs only from a file that the user trusts.

A spec is data. What it names, ``"module:function"``, is looked for in the one Python file given by
``--trust FILE.py`` (or from Python by `trust`), and nowhere else; modules that stand beside that
file can be imported by it.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from importlib.util import module_from_spec, spec_from_file_location
from os import PathLike
from pathlib import Path
from typing import Any

from microswim.errors import SpecError


@dataclass(frozen=True)
class Trusted:
    """A Python file whose functions a spec may name, or none."""

    path: Path | None

    @classmethod
    def file(cls, path: str | PathLike[str] | None) -> Trusted:
        """Return the trusted file at a path; None trusts nothing.

        Raises
        ------
        SpecError
            If it is no Python file.
        """
        if path is None:
            return cls(None)
        path = Path(path)
        if path.suffix != ".py" or not path.is_file():
            raise SpecError("--trust", str(path), "a Python file, FILE.py")
        return cls(path.resolve())

    def function(self, field: str, name: str) -> Callable[..., Any]:
        """Return the function that a field names, ``"module:function"``.

        Raises
        ------
        SpecError
            If the file is not trusted, cannot be run or holds no such function.
        """
        module, colon, function = name.partition(":")
        if not colon or not module.isidentifier() or not function.isidentifier():
            raise SpecError(field, name, '"module:function", a function of module.py')
        if self.path is None:
            raise SpecError(
                field,
                name,
                "trusted before it is run",
                f"a spec runs no code by itself: --trust {module}.py (in Python: trust=)",
            )
        if module != self.path.stem:
            raise SpecError(field, name, f'a function of the trusted file, "{self.path.stem}:..."')
        found = getattr(self._module(), function, None)
        if function.startswith("_") or not callable(found):
            raise SpecError(
                field, name, f"a function of {self.path.name}", "it holds none so named"
            )
        return found

    def _module(self) -> Any:
        """The module of the file as it is now; an unchanged one is not run again."""
        assert self.path is not None
        known, now = sys.modules.get(self.path.stem), (str(self.path), self.path.stat().st_mtime_ns)
        ours = getattr(known, "_microswim_trusted", None)
        if known is not None and ours is None:
            raise SpecError("--trust", self.path.name, "named unlike any other module", "rename it")
        return known if ours == now else _run(self.path, now)


def _run(path: Path, now: tuple[str, int]) -> Any:
    """Import a file under its own name, so that worker processes find it as well."""
    if str(path.parent) not in sys.path:
        sys.path.append(str(path.parent))
    spec = spec_from_file_location(path.stem, path)
    if spec is None or spec.loader is None:
        raise SpecError("--trust", str(path), "a Python file, FILE.py")
    module = module_from_spec(spec)
    module._microswim_trusted = now  # type: ignore[attr-defined]
    sys.modules[path.stem] = module
    try:
        spec.loader.exec_module(module)
    except (Exception, SystemExit) as error:
        del sys.modules[path.stem]
        why = " ".join(f"{type(error).__name__}: {error}".split())
        raise SpecError(f"--trust {path.name}: it cannot be run: {why}") from None
    return module
