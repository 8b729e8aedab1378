"""Writes a model for the simulator in a browser: python -m release.web_model models/digits digits.json."""

import json
import sys
from base64 import b64encode
from pathlib import Path

from tilenca.base.errors import TilencaError
from tilenca.model.file import Model, load_model


def model_json(model: Model) -> str:
    """The integers of a model, row by row, in base64, and its labels; web/src/simulator.js says how."""
    size = model.dimensions
    weights = {name: b64encode(model.integer[name].tobytes()).decode() for name in size.shapes()}
    return json.dumps(
        {
            "channels": size.channels,
            "hidden1": size.hidden1,
            "hidden2": size.hidden2,
            "labels": list(model.labels),
            "weights": weights,
        }
    )


def main(arguments: list[str]) -> int:
    """Writes the file; returns the exit status."""
    if len(arguments) != 2:
        print("usage: python -m release.web_model MODEL FILE", file=sys.stderr)
        return 2
    try:
        Path(arguments[1]).write_text(model_json(load_model(Path(arguments[0]))) + "\n", encoding="ascii")
    except TilencaError as error:
        print(f"web_model: {error}", file=sys.stderr)
        return error.exit_status
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
