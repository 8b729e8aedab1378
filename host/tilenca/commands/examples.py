"""Two examples for the help of each command; the tests parse them all."""

EXAMPLES: dict[str, tuple[str, str]] = {
    "new": ("tilenca new my-tiles", "tilenca new my-tiles --json"),
    "make": ("tilenca make my-shapes.toml", "tilenca make my-shapes.toml --recipe full --out models/mine"),
    "shapes": ("tilenca shapes my-shapes.toml", "tilenca shapes digits --vary 4"),
    "train": (
        "tilenca train --shapes my-shapes.toml --out models/mine --recipe quick",
        "tilenca train --shapes my-shapes.toml --out models/mine --seeds 2 --resume",
    ),
    "runs": ("tilenca runs", "tilenca runs models build/models --plot runs.png"),
    "evaluate": ("tilenca evaluate --model models/mine", "tilenca evaluate --size 9x7 --loss 0.2"),
    "sweep": (
        "tilenca sweep --axis loss=0:0.6:0.1 --runs 20 --out build/loss",
        "tilenca sweep --axis size=5x4,7x6 --axis dead=0,0.1 --out build/dead --plot",
    ),
    "report": ("tilenca report --quick --out build/report", "tilenca report --out build/report --jobs 8"),
    "plot": ("tilenca plot models/mine", "tilenca plot --film four.gif --shape 4"),
    "simulate": ("tilenca simulate --shape 4 --watch", "tilenca simulate --array 100x100 --steps 20"),
    "export": ("tilenca export --model models/mine --build", "tilenca export --plan --hidden 64"),
    "emulate": (
        "tilenca emulate --shape 4 --watch --seconds 10",
        "tilenca emulate --model models/mine --fault loss=0.02",
    ),
    "page": ("tilenca page", "tilenca page --port '/dev/ttyACM*'"),
    "devices": ("tilenca devices", "tilenca devices --port '/dev/ttyACM*' --json"),
    "flash": ("tilenca flash --model models/mine", "tilenca flash --only 7 --force"),
    "set": ("tilenca set brightness 40", "tilenca set period 40 --tile 7"),
    "monitor": ("tilenca monitor --record evening.jsonl", "tilenca monitor --replay evening.jsonl --speed 4"),
}


def epilog(command: str) -> str:
    """The end of a command's help."""
    return "\n".join(["examples:", *(f"  {example}" for example in EXAMPLES[command])])
