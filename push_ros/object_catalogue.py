"""Objects by name: those of the parameters, and those in files."""

from pathlib import Path

from push_model.files.data import share_directory
from push_model.files.parameter_files import files_by_name, read_object
from push_model.parameters import PushedObject
from push_ros.diagnostics import shortened

# Characters of a name that somebody has sent which a message quotes; chosen.
MAX_NAME = 60


class UnknownObject(ValueError):
    """There is no object of a name; the text lists the names there are."""


class ObjectCatalogue:
    """
    Nominal objects that a goal may name.

    An object of the parameters, which somebody has measured, hides a file of its name; a file of
    the user's folder hides one of the package. Files are read when they are asked for.
    """

    def __init__(self, folder: str) -> None:
        """
        Start with the objects in files.

        :param folder: with the user's object files, as in ``config/objects``; empty for none.
        """
        self._folders = [share_directory() / 'config' / 'objects']
        if folder:
            self._folders.append(Path(folder))
        self._own: dict[str, PushedObject] = {}

    def check_folder(self) -> None:
        """
        Refuse a folder of the user that is not there.

        :raises ValueError: naming it.
        """
        for folder in self._folders:
            if not folder.is_dir():
                raise ValueError(f'object_folder: got {str(folder)!r}, expected a folder')

    @property
    def names(self) -> list[str]:
        """Names of all objects, sorted; one of the parameters may have none."""
        return sorted({*self._own, *self._files} - {''})

    @property
    def _files(self) -> dict[str, Path]:
        return {name: path for folder in self._folders
                for name, path in files_by_name(folder).items()}

    def remember(self, name: str, obj: PushedObject) -> None:
        """
        Note an object of the parameters, unless it is that of its name anyhow.

        :param name: its name, or empty.
        """
        try:
            is_known = self.find(name) == obj
        except ValueError:
            is_known = False
        if not is_known:
            self._own[name] = obj

    def find(self, name: str) -> PushedObject:
        """
        Find an object.

        :param name: its name; empty for the one of the parameters without a name.
        :raises UnknownObject: where there is none, with the names there are.
        :raises ValueError: where its file cannot be read, naming file and key.
        """
        if name in self._own:
            return self._own[name]
        files = self._files
        if name not in files:
            raise UnknownObject(f'object_name: got {shortened(name, MAX_NAME)!r}, expected one of '
                                + ', '.join(self.names))
        return read_object(files[name])
