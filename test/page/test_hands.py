"""What hands do on the page, and what it says of the tiles then; its modules run without a browser."""

from collections.abc import Iterator

import pytest

from support.page_node import PageNode

EIGHT = ["####", "#..#", "####", "#..#", "####"]
NINE = ["####", "#..#", "####", "...#", "####"]

SCRIPT = """
class Fake extends EventTarget {
  textContent = ""; hidden = false; value = "0";
  setPointerCapture() {}
  getBoundingClientRect() { return { left: 0, top: 0 }; }
  point(name, [clientX, clientY], more) {
    const pointer = { button: 0, pointerId: 1, clientX, clientY, ...more };
    this.dispatchEvent(Object.assign(new Event(name), pointer));
  }
}
const kept = new Map();
const [getItem, setItem] = [(key) => kept.get(key) ?? null, (key, text) => kept.set(key, text)];
globalThis.localStorage = { getItem, setItem };
globalThis.matchMedia = () => new Fake();
const { cellsOf, telling } = await import("./stream/drawing.js");
const { STEPS } = await import("./stream/lessons.js");
const { Tiles } = await import("./stream/tiles.js");
const { Hands } = await import("./components/hands.js");
const { Hint } = await import("./components/hint.js");
const { deliberate } = await import("./components/slider.js");
const { verdictOn } = await import("./components/verdict.js");
const { View } = await import("./components/view.js");

const portOf = (at) => `tile-${String(at + 1).padStart(2, "0")}`;
function lay({ rows, shows = "", drawings = [], off = [], cut = [], turned = [] }) {
  const tiles = new Tiles();
  const named = drawings.map(([label, grid]) => ({ name: label, label, rows: grid }));
  const source = { stream: 1, source: "emulated", drawings: named, most_tiles: 99, most_place: 99 };
  tiles.take([{ time: 0, ...source }, { time: 0, run: { seed: 0, tiles: 1 } }]);
  cellsOf(rows).forEach((place, at) => {
    const [time, port] = [0, portOf(at)];
    tiles.take([{ time, port, place, tile: at + 1 }, { time, port, open: !off.includes(at + 1) }]);
    tiles.tile(port).label = off.includes(at + 1) ? "" : shows[at % shows.length] ?? "";
    tiles.tile(port).turned = turned.includes(at + 1);
  });
  for (const [at, side] of cut) tiles.take([{ time: 0, port: portOf(at - 1), side, cable: "cut" }]);
  return tiles;
}

const ways = {
  verdict: (board) => verdictOn(lay(board)).text,
  signs: (board) => {
    const tiles = lay(board);
    return [0, 1, 2, 3].map((side) => tiles.cableAt(tiles.tile("tile-01"), side));
  },
  tools: () => STEPS.map(({ tool }) => tool),
  telling: ({ rows, drawings }) => telling(cellsOf(rows), lay({ rows, drawings }).drawings),
  // The numbers of places with tiles after strokes with the pencil, each from place to place.
  draw: ({ rows, strokes }) => {
    const [board, tiles, view] = [new Fake(), lay({ rows }), new View()];
    let count = 99;
    const deeds = new Proxy({
      put: (place) => tiles.take([{ time: 0, port: `tile-${count++}`, place, tile: count }]),
      pull: (port) => tiles.take([{ time: 0, port, place: null }]),
    }, { get: (own, name) => own[name] ?? (() => {}) });
    const hands = new Hands(board, tiles, view, deeds);
    view.isWide = true;
    view.fit([[0, 0], [4, 3]], 358, 523);
    hands.tool = "pencil";
    for (const [first, ...others] of strokes) {
      board.point("pointerdown", view.middle(...first));
      for (const place of others) board.point("pointermove", view.middle(...place));
      board.point("pointerup", view.middle(...(others.at(-1) ?? first)));
    }
    return [...tiles.byPlace.keys()].sort();
  },
  targets: ({ size: [width, height], points }) => {
    const view = new View();
    view.fit([[0, 0], [4, 3]], width, height);
    return points.map((point) => view.target(point));
  },
  // How far the faces of all places in reach are from the edges, in pixels.
  rim: ({ size: [width, height], isWide }) => {
    const view = new View();
    view.isWide = isWide;
    view.fit([[0, 0], [4, 3]], width, height);
    return Math.min(...view.places().flatMap((place) => {
      const [x, y] = view.corner(...place);
      return [x, y, width - x - view.size, height - y - view.size].map((far) => far + 0.07 * view.size);
    }));
  },
  hint: ({ rows, drawings, deeds }) => {
    kept.clear();
    const told = [];
    for (let visit = 0; visit < 2; visit++) {
      const [root, named] = [new Fake(), []];
      const board = { isBusy: () => false, name: (port) => named.push(port) };
      const hint = new Hint(root, lay({ rows, drawings }), board);
      hint.update();
      told.push(root.hidden ? "" : root.textContent, named.at(-1));
      for (const deed of deeds) hint.note(deed);
    }
    return told;
  },
  slide: ({ to, end }) => {
    const slider = new Fake();
    const heard = [];
    deliberate(slider);
    slider.addEventListener("input", () => heard.push(slider.value));
    slider.point("pointerdown", [100, 100], { pointerType: "touch" });
    slider.value = "5";
    slider.dispatchEvent(new Event("input"));
    if (to) {
      slider.point("pointermove", to);
      slider.value = "7";
      slider.dispatchEvent(new Event("input"));
    }
    slider.point(end, to ?? [100, 100]);
    return [slider.value, heard];
  },
};
const answer = ([name, argument]) => ways[name](argument);
"""


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[PageNode]:
    with PageNode(tmp_path_factory.mktemp("page"), SCRIPT) as node:
        yield node


def test_two_groups_that_are_of_one_mind_each_are_told_as_two(page: PageNode) -> None:
    apart = ["##..", "##.#", "...#"]
    assert page.ask(["verdict", {"rows": apart, "shows": "667611"}]) == "3 of 6 show 6"
    told = page.ask(["verdict", {"rows": apart, "shows": "666611"}])
    assert told == "2 groups: 4 show 6, 2 show 1"
    cut = {"rows": ["###"], "shows": "991", "cut": [[2, "E"]]}
    assert page.ask(["verdict", cut]) == "2 groups: 2 show 9, 1 shows 1"
    dead = {"rows": ["###"], "shows": "9-1", "off": [2]}
    assert page.ask(["verdict", dead]) == "2 groups: 1 shows 9, 1 shows 1, 1 has no power"


def test_a_tile_without_power_is_told_where_the_others_agree(page: PageNode) -> None:
    assert page.ask(["verdict", {"rows": ["####"], "shows": "1", "off": [4]}]) == (
        "All 3 tiles show 1, 1 has no power"
    )


def test_a_cut_cable_is_told_from_that_of_a_turned_tile(page: PageNode) -> None:
    board = {"rows": ["##", "#."], "turned": [2], "cut": [[1, "S"]]}
    assert page.ask(["signs", board]) == ["whole", "turned", "cut", "whole"]


def test_each_step_of_the_lesson_has_the_tool_that_it_needs(page: PageNode) -> None:
    assert page.ask(["tools", None]) == ["hand"] * 6 + ["knife", "pencil"]


def test_the_tile_without_which_an_8_is_a_9_is_known(page: PageNode) -> None:
    drawings = [["8", EIGHT], ["9", NINE]]
    assert page.ask(["telling", {"rows": EIGHT, "drawings": drawings}]) == [3, 0]
    assert page.ask(["telling", {"rows": NINE, "drawings": drawings}]) is None
    assert page.ask(["telling", {"rows": ["##"], "drawings": drawings}]) is None


def test_the_hint_names_that_tile_and_stays_away_once_a_tile_was_pulled(page: PageNode) -> None:
    board = {"rows": EIGHT, "drawings": [["8", EIGHT], ["9", NINE]]}
    words = "Drag tile 11 out of this frame, and watch the others"
    assert page.ask(["hint", {**board, "deeds": []}]) == [words, "tile-11"] * 2
    assert page.ask(["hint", {**board, "deeds": ["pull"]}]) == [words, "tile-11", "", ""]


def test_a_stroke_that_leaves_a_tile_draws_on_and_one_over_tiles_rubs_out(page: PageNode) -> None:
    top, down = [[0, 0], [0, 3]], [[0, 3], [1, 3], [2, 3]]
    seven = ["0,0", "0,1", "0,2", "0,3", "1,3", "2,3"]
    assert page.ask(["draw", {"rows": [], "strokes": [top, down]}]) == seven
    assert page.ask(["draw", {"rows": [], "strokes": [top, [[0, 3], [0, 2]]]}]) == ["0,0", "0,1"]
    assert page.ask(["draw", {"rows": [], "strokes": [top, [[0, 3]]]}]) == ["0,0", "0,1", "0,2"]


def test_a_tile_is_taken_out_beyond_the_frame_and_where_it_says_so(page: PageNode) -> None:
    phone = {"size": [358, 523], "points": [[-1, 300], [179, 510], [120, 200], [5, 5]]}
    assert page.ask(["targets", phone]) == ["out", "out", [1, 1], None]
    laptop = {"size": [870, 478], "points": [[860, 240], [435, 470], [10, 240]]}
    assert page.ask(["targets", laptop]) == ["out", [5, 2], None]


@pytest.mark.parametrize("is_wide", [False, True])
def test_no_face_touches_the_frame(page: PageNode, is_wide: bool) -> None:
    for height in range(300, 700, 7):
        assert page.ask(["rim", {"size": [870, height], "isWide": is_wide}]) >= 2


def test_a_finger_that_scrolls_sets_no_slider(page: PageNode) -> None:
    assert page.ask(["slide", {"to": [102, 180], "end": "pointercancel"}]) == ["0", []]
    assert page.ask(["slide", {"to": [140, 102], "end": "pointerup"}]) == ["7", ["7"]]
    assert page.ask(["slide", {"to": None, "end": "pointerup"}]) == ["5", ["5"]]
