"""The files that Drake's model directives add."""

from __future__ import annotations

from pathlib import Path

from pydrake.multibody.parsing import (
    FlattenModelDirectives,
    LoadModelDirectives,
    PackageMap,
)

from drake_screw.errors import ModelError

SUFFIX = ".dmd.yaml"


def is_directives(file: Path) -> bool:
    """Whether a file is one of Drake's model directives, by its name."""
    return file.name.endswith(SUFFIX)


def model_files(file: Path, packages: PackageMap) -> tuple[tuple[str | None, Path], ...]:
    """The files of the models that a model file adds, and what each is called.

    A file of directives adds any number, of names that it gives them; another file adds what it
    has, under names of its own (None).

    Raises:
        ModelError: directives cannot be read, or name a file or package that there is not.
    """
    if not is_directives(file):
        return ((None, file),)
    try:
        flat = FlattenModelDirectives(LoadModelDirectives(str(file)), packages)
        return tuple(
            (one.add_model.name, Path(packages.ResolveUrl(one.add_model.file)))
            for one in flat.directives
            if one.add_model is not None
        )
    except (RuntimeError, ValueError, SystemExit) as error:
        raise directives_error(file, error) from error


def directives_error(file: Path, error: BaseException) -> ModelError:
    """What to say of directives that Drake cannot read."""
    return ModelError(
        f"Drake cannot read these model directives: {error}",
        remedy="Each add_model names a file as package://NAME/PATH, a package being a folder "
        "that has a package.xml.",
        file=file,
    )
