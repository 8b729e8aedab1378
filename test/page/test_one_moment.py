"""What the page says of a moment is what the faces of the tiles show then."""

from pathlib import Path

from support.page_node import PageNode

SCRIPT = """
import { Tiles } from "./stream/tiles.js";
function answer(events) {
  const tiles = new Tiles();
  tiles.take(events);
  const shown = tiles.laid().map((tile) => tiles.shown(tile));
  return [[...tiles.count().counts], shown, tiles.history.changeCount];
}
"""
LOOKS = [{"label": label, "segments": int(label), "rgb": [9, 9, 9]} for label in "45"]


def shows(segments: int, light: int = 9) -> dict[str, object]:
    display = {"segments": segments, "rgb": [light] * 3, "leds": "----"}
    return {"time": 1, "port": "tile-01", "display": display}


def test_a_face_is_ahead_of_what_its_tile_says(tmp_path: Path) -> None:
    begin = [
        {"time": 0, "stream": 1, "source": "emulated", "looks": LOOKS},
        {"time": 0, "run": {"seed": 0, "tiles": 1}},
        {"time": 0, "port": "tile-01", "place": [0, 0]},
        {"time": 0, "port": "tile-01", "open": True},
    ]
    says_four = {"time": 1, "port": "tile-01", "raw": "$TILE,1,7,7,4,4,3,----,80*1E"}
    with PageNode(tmp_path, SCRIPT) as page:
        assert page.ask([*begin, shows(0, 0)]) == [[["", 1]], [""], 0]
        assert page.ask([*begin, says_four, shows(4)]) == [[["4", 1]], ["4"], 0]
        assert page.ask([*begin, says_four, shows(5)]) == [[["5", 1]], ["5"], 0], "no change until it says so"
        assert page.ask([*begin, says_four, shows(0, 0)])[1] == ["4"], "its light blinks"
        off = {"time": 2, "port": "tile-01", "open": False}
        assert page.ask([*begin, says_four, shows(5), off])[1] == [""]
