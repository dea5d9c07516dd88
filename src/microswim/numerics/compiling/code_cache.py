"""Where Numba keeps compiled code, and under which names.

Numba knows the file of a kernel, not those of the kernels it calls: edit a callee, and old numbers
come back. Here each name carries a digest of all that a kernel is made of, so that code for other
sources is never found. Two private parts of Numba's cache are renamed for it (`index` and `data`
names of ``dispatcher._cache._cache_file``); a test says what breaks when Numba changes them.
"""

from __future__ import annotations

import atexit
import hashlib
import os
import shutil
import tempfile
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from types import CodeType, ModuleType
from typing import Any

import numpy as np


def digest(function: Callable[..., Any], options: dict[str, Any]) -> str:
    """Return a digest of a kernel: its code, the constants it reads, the kernels it calls, and in
    which modules they stand: kept code imports them by name.
    """
    chosen = [(name, sorted(v) if isinstance(v, set) else v) for name, v in options.items()]
    whole = hashlib.sha256(repr(sorted(chosen)).encode())
    for part in _parts_of(function, set()):
        whole.update(part)
    return whole.hexdigest()[:16]


def _parts_of(function: Callable[..., Any], seen: set[int]) -> Iterator[bytes]:
    if id(function) in seen:
        return
    seen.add(id(function))
    code = function.__code__
    yield f"{function.__module__}.{function.__qualname__}".encode()  # code is kept with its callees
    yield code.co_code
    for constant in code.co_consts:
        yield constant.co_code if isinstance(constant, CodeType) else repr(constant).encode()
    for name in code.co_names:
        yield name.encode()
        value = function.__globals__.get(name)
        if isinstance(value, ModuleType) and value.__name__.startswith("microswim."):
            for inner in code.co_names:
                yield from _parts(getattr(value, inner, None), seen)
        else:
            yield from _parts(value, seen)


def _parts(value: Any, seen: set[int]) -> Iterator[bytes]:
    """Yield what a global of a kernel adds: a constant's value, the parts of another kernel."""
    written = getattr(value, "py_func", None)
    if written is not None:
        yield from _parts_of(written, seen)
    elif isinstance(value, np.ndarray):
        yield value.tobytes()
    elif isinstance(value, (bool, int, float, complex, str, tuple)):
        yield repr(value).encode()
    elif hasattr(value, "_fields"):  # a record
        yield repr(value._fields).encode()


def keep(compile_it: Callable[[], Any], made_of: str) -> Any:
    """Return a dispatcher whose compiled code is kept, under names that carry the digest.

    Where neither the package nor the user's cache folder can be written, a temporary folder serves
    for this process and the processes it starts.
    """
    try:
        made = compile_it()
    except RuntimeError as error:
        if "cannot cache function" not in str(error):
            raise
        _use_temporary_folder()
        made = compile_it()
    cache = getattr(made, "_cache", None)  # none where NUMBA_DISABLE_JIT leaves functions alone
    if cache is not None:
        _rename(cache._cache_file, made_of)
    return made


def _rename(stored: Any, made_of: str) -> None:
    """Name the index by the digest, and each file of code by the digest and its types.

    Numba numbers the files 1, 2, ...: of two processes that compile for different types at once
    one could overwrite what the other has listed, and the list would lead to code for other types.
    """
    base = stored._index_name.removesuffix(".nbi")
    stored._index_name = f"{base}.{made_of}.nbi"
    stored._index_path = os.path.join(stored._cache_path, stored._index_name)
    save = stored.save

    def save_by_types(key: Any, data: Any) -> None:
        types = hashlib.sha256(repr(key).encode()).hexdigest()[:16]
        stored._data_name = lambda number: f"{base}.{made_of}.{types}.nbc"
        save(key, data)
        for old in Path(stored._cache_path).glob(f"{base}.*"):
            if made_of not in old.name:
                old.unlink(missing_ok=True)

    stored.save = save_by_types


def _use_temporary_folder() -> None:
    """Let Numba keep code in a new folder that goes with this process, and say so once."""
    from numba import config

    folder = tempfile.mkdtemp(prefix="microswim-")
    owner = os.getpid()

    def remove() -> None:
        if os.getpid() == owner:
            shutil.rmtree(folder, ignore_errors=True)

    atexit.register(remove)
    os.environ["NUMBA_CACHE_DIR"] = folder
    config.__dict__["CACHE_DIR"] = folder
    warnings.warn(
        "compiled code cannot be kept: neither the package's folder nor the user's cache folder "
        f"can be written; it is kept in {folder} until this process ends, and compiled anew by the "
        "next (to keep it, set NUMBA_CACHE_DIR to a folder that can be written)",
        stacklevel=2,
    )
