"""A run's files, both ways: run.json, and the instances of a round."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import TypeAdapter, ValidationError
from pydantic_core import ErrorDetails

from drake_screw.acquisition import Evaluation, Executed
from drake_screw.bandits import Cell
from drake_screw.errors import RunDirectoryError
from drake_screw.json_values import decode_json
from drake_screw.planning import Cause, Outcomes
from drake_screw.runs.certificate import Certificate
from drake_screw.runs.records import RunRecord, SuggestionRecord
from drake_screw.tasks import PLANAR
from drake_screw.typing import Array

FORMAT = 1
REMEDY = "Restore it, or run the scenario again."
_ADAPTERS: dict[type, TypeAdapter[Any]] = {
    kind: TypeAdapter(kind) for kind in (RunRecord, Certificate, SuggestionRecord)
}


def plain(record: RunRecord | Certificate | SuggestionRecord) -> dict[str, Any]:
    """A record in plain data, as JSON has it."""
    data: dict[str, Any] = _ADAPTERS[type(record)].dump_python(record, mode="json")
    if isinstance(record, Certificate):
        return _applicable(data)
    if isinstance(record, RunRecord) and record.certificate is not None:
        data["certificate"] = _applicable(data["certificate"])
    return data


def json_text(record: RunRecord | Certificate | SuggestionRecord) -> str:
    """A record as the text of a JSON file; of a path that is no UTF-8, ? for what is none."""
    text = json.dumps(plain(record), indent=2, ensure_ascii=False)
    return text.encode("utf-8", "replace").decode() + "\n"


def read_run_record(file: Path) -> RunRecord:
    """Read run.json.

    Raises:
        RunDirectoryError: it cannot be read, is damaged, or is of another version.
    """
    try:
        text = file.read_text(encoding="utf-8")
        data = decode_json(text)
    except (OSError, ValueError) as error:
        raise RunDirectoryError(f"damaged: {error}", remedy=REMEDY, file=file) from error
    if not isinstance(data, dict) or not isinstance(data.get("format"), int):
        raise RunDirectoryError(
            "not what a run writes: it has no number of its format", remedy=REMEDY, file=file
        )
    if data["format"] != FORMAT:
        writer = data.get("versions")
        version = writer.get("drake-screw") if isinstance(writer, dict) else None
        which = "" if version is None else f", drake-screw {version}"
        raise RunDirectoryError(
            f"written in format {data['format']}; this version reads format {FORMAT}",
            remedy=f"Use the version that wrote it{which}.",
            file=file,
        )
    try:
        record: RunRecord = _ADAPTERS[RunRecord].validate_json(text, strict=True)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        raise RunDirectoryError(f"damaged: {_oddity(first)}", remedy=REMEDY, file=file) from error
    if record.certificate is None:
        return record
    return replace(record, certificate=replace(record.certificate, reason=record.reason or ""))


def save_evaluation(file: Path, evaluation: Evaluation) -> None:
    """Write the instances of a round and their outcomes as .npz."""
    outcomes = evaluation.outcomes
    arrays: dict[str, Any] = {
        **_coordinate_arrays(evaluation.coordinates),
        "region": _unsigned(evaluation.region),
        "cause": outcomes.cause,
        "segment": outcomes.segment,
        "joint": outcomes.joint,
        "fraction": outcomes.fraction,
        "variant": outcomes.variant,
        "pair": outcomes.pair,
        "arm": outcomes.arm,
        **_frontier_arrays(evaluation.frontier),
        **_executed_arrays(evaluation.executed),
    }
    np.savez_compressed(file, **arrays)


def load_evaluation(file: Path) -> Evaluation:
    """Read what `save_evaluation` wrote.

    Raises:
        OSError, EOFError, ValueError, KeyError, TypeError, BadZipFile, zlib.error: it is missing,
            cut off, or not such a file.
    """
    with np.load(file) as data:
        outcomes = Outcomes(
            data["cause"],
            data["segment"],
            data["joint"],
            data["fraction"],
            data.get("variant", np.zeros(data["cause"].shape, dtype=np.int16)),  # one in old runs
            data.get("pair"),  # not known in old runs
            data.get("arm"),  # the only one in old runs
        )
        coordinates, region = _coordinates(data), data["region"]
        _check("x_y_yaw", coordinates, "f", (..., ..., ...))
        _check("region", region, "iu", (...,))
        if region.min(initial=0) < 0:
            raise ValueError("region holds numbers below 0")
        if not np.isfinite(coordinates).all():
            raise ValueError("x_y_yaw holds numbers that are not finite")
        for name, array in vars(outcomes).items():
            _check(name, array, "f" if name == "fraction" else "iu", outcomes.shape)
        if not np.isin(outcomes.cause, list(Cause)).all():
            raise ValueError("cause holds numbers that stand for none")
        region = region.astype(np.int64)
        return Evaluation(coordinates, region, outcomes, _frontier(data), _executed(data))


def _check(name: str, array: NDArray[Any], kinds: str, shape: tuple[Any, ...]) -> None:
    """Refuse an array of another kind or shape; ... stands for any length.

    Raises:
        ValueError: it is such a one.
    """
    fits = len(array.shape) == len(shape) and all(
        wanted in (..., found) for wanted, found in zip(shape, array.shape, strict=True)
    )
    if array.dtype.kind not in kinds or not fits:
        raise ValueError(f"{name} is of type {array.dtype} and shape {array.shape}")


def _coordinate_arrays(coordinates: Array) -> dict[str, Array]:
    """x, y, yaw by themselves, as they are in every run."""
    planar, others = coordinates[..., :PLANAR], coordinates[..., PLANAR:]
    return {"x_y_yaw": planar} | ({"z_roll_pitch": others} if others.shape[-1] else {})


def _coordinates(data: Mapping[str, Array]) -> Array:
    """What `_coordinate_arrays` made arrays of."""
    planar = data["x_y_yaw"]
    if "z_roll_pitch" not in data:
        return planar
    return np.concatenate([planar, data["z_roll_pitch"]], axis=-1)


def _applicable(certificate: Mapping[str, Any]) -> dict[str, Any]:
    """A certificate's entries that apply, without the reason, which stands in run.json itself."""
    return {k: v for k, v in certificate.items() if v is not None and k != "reason"}


def _oddity(error: ErrorDetails) -> str:
    """What is not as a run leaves it."""
    missing, found = error["type"] == "missing", f"{error['input']!r}"
    match error["loc"]:
        case ("status",) if not missing:
            return f"no run has the status '{error['input']}'"
        case ("rounds" | "demonstrations" as block, int(number)) if error["type"] == "value_error":
            return f"what it says of {block[:-1]} {number + 1} is {error['ctx']['error']}"
        case ("rounds" | "demonstrations" as block, int(number)):
            return f"what it says of {block[:-1]} {number + 1} is {found}"[:80]
        case ("rounds" | "demonstrations" as block, int(number), *rest):
            what, inner = f"what it says of {block[:-1]} {number + 1}", _dotted(rest)
            if missing:
                return f"{what} is incomplete: no '{inner}'"
            return f"{what} is damaged: '{inner}' is {found}"[:120]
        case where:
            return f"no '{_dotted(where)}'" if missing else f"'{_dotted(where)}' is {found}"[:80]


def _dotted(where: tuple[int | str, ...] | list[int | str]) -> str:
    return ".".join(str(part) for part in where)


def _unsigned(region: NDArray[np.int64]) -> NDArray[Any]:
    """As the least of uint16, uint32 and uint64 that holds all regions."""
    least = np.min_scalar_type(region.max(initial=0))
    return region.astype(np.promote_types(np.uint16, least))


def _executed_arrays(executed: Executed | None) -> dict[str, NDArray[Any]]:
    if executed is None:
        return {}
    return {f"executed_{field.name}": getattr(executed, field.name) for field in fields(Executed)}


def _executed(data: Mapping[str, NDArray[Any]]) -> Executed | None:
    """What `_executed_arrays` made arrays of."""
    if "executed_ran" not in data:
        return None
    return Executed(**{field.name: data[f"executed_{field.name}"] for field in fields(Executed)})


def _frontier_arrays(frontier: tuple[Cell, ...]) -> dict[str, NDArray[Any]]:
    """The cells as arrays with a first axis for cells, and of samples, cell after cell."""
    if not frontier:
        return {}
    each = ("lower", "upper", "depth", "epoch", "cleared", "n")
    arrays = {f"cell_{name}": np.array([getattr(c, name) for c in frontier]) for name in each}
    points = np.concatenate([cell.points for cell in frontier])
    failed = np.concatenate([cell.failed for cell in frontier])
    return {**arrays, "cell_points": points, "cell_failed": failed}


def _frontier(data: Mapping[str, NDArray[Any]]) -> tuple[Cell, ...]:
    """What `_frontier_arrays` made arrays of."""
    if "cell_n" not in data:
        return ()
    ends = np.cumsum(data["cell_n"])[:-1]
    columns = (
        data["cell_lower"],
        data["cell_upper"],
        data["cell_depth"].tolist(),
        data["cell_epoch"].tolist(),
        np.split(data["cell_points"], ends),
        np.split(data["cell_failed"], ends),
        data["cell_cleared"].tolist(),
    )
    return tuple(Cell(*values) for values in zip(*columns, strict=True))
