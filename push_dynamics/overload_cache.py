"""
Machine code of numba's functions, in a private folder.

It takes the place of numba's own cache, which unpickles whatever lies in its folder: who can write
a file there can do anything.
"""

from collections.abc import Callable
import hashlib
import pickle
import sys
from typing import Any

from push_dynamics.private_folder import PrivateFolder


class OverloadCache:
    """
    Cache of a function for numba: each combination of argument types has a file.

    ``cache_path``: of the folder.
    """

    def __init__(self, numba: Any, function: Callable[..., Any], folder: PrivateFolder,
                 name: str) -> None:
        """
        Read nothing yet.

        :param numba: the module.
        :param function: plain Python, without variables of a function around it.
        :param name: beginning of the names of files; no other function has it.
        """
        self._numba = numba
        self._folder = folder
        self._name = name
        code = function.__code__
        self._versions = (numba.__version__, sys.version_info[:2], code.co_firstlineno,
                          code.co_code)
        self.cache_path = str(folder.path)

    def load_overload(self, signature: Any, target_context: Any) -> Any:
        """
        Load machine code; None where there is none.

        :param signature: types of the arguments.
        :param target_context: numba's context of the processor.
        """
        key = self._key(signature, target_context.codegen())
        content = self._folder.read(self._file_name(key))
        if content is None:
            return None
        # What only the compiler needs is left out: to import it takes as long as all the rest.
        self._numba.core.runtime.rtsys.initialize(target_context)
        try:
            written_key, parts = pickle.loads(content)
        except (AttributeError, ImportError):
            # The type of an argument is gone, as after an update.
            return None
        if written_key != key:
            return None
        return self._numba.core.compiler.CompileResult._rebuild(target_context, *parts)

    def save_overload(self, signature: Any, result: Any) -> None:
        """
        Write machine code.

        :param signature: types of the arguments.
        :param result: numba's ``CompileResult``.
        """
        # Addresses in this process mean nothing to others.
        if result.lifted or result.library.has_dynamic_globals:
            return
        key = self._key(signature, result.codegen)
        content = self._numba.core.serialize.dumps((key, result._reduce()))
        self._folder.write(self._file_name(key), content)

    def _key(self, signature: Any, codegen: Any) -> tuple[Any, ...]:
        return signature, codegen.magic_tuple(), self._versions

    def _file_name(self, key: tuple[Any, ...]) -> str:
        """Name a file; types of the same name share one, which tells which of them it is for."""
        digest = hashlib.sha256(repr(key).encode()).hexdigest()
        return f'{self._name}-{digest[:16]}.code'
