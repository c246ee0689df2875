"""verdict.json: the one writer and the one reader."""

from __future__ import annotations

import json
from pathlib import Path

from pydantic import ValidationError

from vibroimpact.records import RecordError, read_text, write_text

from .content import Verdict


def write_verdict(verdict: Verdict, path: str | Path) -> None:
    """Write a verdict as JSON. The file appears whole or not at all.

    Raises pydantic.ValidationError where the content does not keep the schema.
    """
    values = Verdict.from_values(verdict.to_values()).to_values()
    write_text(json.dumps(values, indent=1, allow_nan=False), path)


def read_verdict(path: str | Path) -> Verdict:
    """Return the verdict of a file.

    Raises RecordError where there is no such file, or it is no verdict.
    """
    try:
        return Verdict.model_validate(json.loads(read_text(path)))
    except (json.JSONDecodeError, ValidationError) as error:
        raise RecordError(f"{path}: is no verdict: {error}") from error
