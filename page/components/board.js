// The board: tiles and empty places as buttons, with the cables over them; by pointer and by keyboard.

/** @import { Lens } from "../stream/lens.js" */
/** @import { Place } from "../stream/source.js" */
/** @import { Tile } from "../stream/tile.js" */
/** @import { Tiles } from "../stream/tiles.js" */
/** @import { Deeds } from "./hands.js" */
import { clusterOf, isFree } from "../stream/groups.js";
import { OFFSETS, SIDES } from "../stream/source.js";
import { Cables } from "./cables.js";
import { byId, calm, element, narrow, setText } from "./dom.js";
import { Hands } from "./hands.js";
import { TileView } from "./tile.js";
import { MARGIN_PX, View } from "./view.js";

/** @type {Record<string, number>} */
const ARROWS = { ArrowUp: 0, ArrowRight: 1, ArrowDown: 2, ArrowLeft: 3 };

// Between a tile and what would lie over it.
const GAP_PX = 12;

/** @typedef {Pick<Deeds, "select" | "put" | "pull" | "move" | "shift" | "cut"> & {say: (text: string) => void}} BoardDeeds */

export class Board {
  /** @param {HTMLElement} root @param {Tiles} tiles @param {BoardDeeds} deeds */
  constructor(root, tiles, deeds) {
    this.root = root;
    this.tiles = tiles;
    this.deeds = deeds;
    this.view = new View();
    this.cables = new Cables();
    /** @type {Map<string, TileView>} */
    this.views = new Map();
    /** Empty places, "row,col". @type {Map<string, HTMLButtonElement>} */
    this.spots = new Map();
    /** @type {string | null} */
    this.selected = null;
    /** What the colours of the tiles tell; null: their LEDs. @type {Lens | null} */
    this.lens = null;
    /** The place that Tab leads to. @type {Place} */
    this.at = [0, 0];
    /** The tile that the hint names; "": none. */
    this.named = "";
    /** Ports of the tiles in the hand. @type {string[]} */
    this.lifted = [];
    this.isAwake = false;
    this.jumps = 0;
    /** Whether the view was chosen for one who draws. */
    this.isDrawing = false;
    this.hands = new Hands(root, tiles, this.view, {
      ...deeds,
      lift: (ports, dx, dy, place) => this.lift(ports, dx, dy, place),
      drop: () => this.drop(),
      stroke: (points) => {
        this.cables.stroke = points;
        this.cables.isStale = true;
        this.wake();
      },
    });
    root.append(...this.cables.canvases);
    root.addEventListener("keydown", (event) => this.key(event));
    root.addEventListener("click", (event) => this.click(event));
    root.addEventListener("focusin", (event) => this.focused(event));
    new ResizeObserver(() => {
      this.arrange();
      this.wake(); // what it has cleared is drawn again, also while time stands
    }).observe(root);
  }

  /** Shows with the next frame what a hand has changed: a source tells nothing while time stands. */
  wake() {
    if (this.isAwake) return;
    this.isAwake = true;
    requestAnimationFrame((now) => {
      this.isAwake = false;
      this.update(now);
    });
  }

  /** Shows what is new; once for every frame. @param {number} now */
  update(now) {
    if (this.tiles.isMoved && (!this.hands.grip?.moved || this.hands.tool === "pencil")) {
      this.tiles.isMoved = false;
      this.arrange();
    }
    for (const port of this.tiles.dirty) {
      const tile = this.tiles.byPort.get(port);
      if (tile) this.views.get(port)?.update(tile, this.tiles.shown(tile), port === this.selected, this.lens);
    }
    this.tiles.dirty.clear();
    if (this.jumps !== this.tiles.jumps) this.cables.flights = []; // they were of another time
    this.jumps = this.tiles.jumps;
    this.cables.launch(this.tiles.pulses, this.tiles, this.view, now);
    this.tiles.pulses = [];
    this.cables.draw(this.tiles, this.view, now);
  }

  /** @param {string | null} port */
  select(port) {
    for (const one of [this.selected, port]) if (one) this.tiles.dirty.add(one);
    this.selected = port;
    this.wake();
  }

  /** @param {import("./hands.js").Tool} tool */
  choose(tool) {
    this.hands.tool = tool;
    this.root.dataset.tool = tool;
    this.isDrawing = false;
    this.tiles.isMoved = true; // who draws has more room
    this.wake();
  }

  /** Scrolls the page so that a tile lies above what lies over the lower part of the window. @param {string} port @param {HTMLElement} over */
  bring(port, over) {
    const button = this.views.get(port)?.button;
    if (!button || !narrow.matches) return;
    const hidden = button.getBoundingClientRect().bottom + GAP_PX - over.getBoundingClientRect().top;
    if (hidden > 0) window.scrollBy({ top: hidden, behavior: calm.matches ? "auto" : "smooth" });
  }

  /** Marks the tile that the hint names. @param {string} port "": none */
  name(port) {
    if (port === this.named) return;
    this.named = port;
    for (const [one, { button }] of this.views) button.classList.toggle("named", one === port);
  }

  /** Looks at the tiles in another way. @param {Lens | null} lens */
  look(lens) {
    this.lens = lens;
    this.root.classList.toggle("looks", lens !== null);
    for (const tile of this.tiles.laid()) this.views.get(tile.port)?.update(tile, this.tiles.shown(tile), tile.port === this.selected, lens);
  }

  /** Puts everything in its place. */
  arrange() {
    const hadFocus = this.root.contains(document.activeElement);
    const { clientWidth: width, clientHeight: height } = this.root;
    const laid = this.tiles.laid();
    const places = laid.map((tile) => tile.place);
    // Who draws finds each place where it was, until the tool changes or something lies out of reach.
    const isDrawing = this.isDrawing && (laid.length > 0 || this.hands.grip !== null);
    if (!isDrawing || !this.view.shows(places, width, height)) {
      this.view.fit([...places, ...(isDrawing ? this.view.ends() : [])], width, height);
    }
    this.isDrawing = this.view.isWide = this.hands.tool === "pencil";
    this.root.style.setProperty("--size", `${this.view.size}px`);
    this.root.classList.toggle("small", this.view.size < 58);
    this.cables.resize(width, height);
    const gone = new Set(this.views.keys());
    for (const tile of laid) {
      gone.delete(tile.port);
      let view = this.views.get(tile.port);
      if (!view) {
        view = new TileView(tile);
        this.views.set(tile.port, view);
        this.root.append(view.button);
      }
      move(view.button, this.view.corner(...tile.place));
      view.button.classList.toggle("named", tile.port === this.named);
      view.update(tile, this.tiles.shown(tile), tile.port === this.selected, this.lens);
    }
    for (const port of gone) {
      this.views.get(port)?.button.remove();
      this.views.delete(port);
    }
    const ys = laid.map(({ place }) => this.view.corner(...place)[1]);
    this.root.classList.toggle("high", Math.min(...ys) < MARGIN_PX); // words at the upper edge would lie on tiles
    this.root.classList.toggle("low", Math.max(...ys) + this.view.size > height - MARGIN_PX);
    this.arrangeSpots();
    this.rove(this.at, hadFocus && !this.root.contains(document.activeElement));
  }

  arrangeSpots() {
    const gone = new Set(this.spots.keys());
    for (const place of this.tiles.can("put") ? this.view.places() : []) {
      const key = place.join();
      if (this.tiles.at(...place)) continue;
      gone.delete(key);
      let spot = this.spots.get(key);
      if (!spot) {
        spot = element("button", {
          type: "button", class: "spot", tabindex: -1, "data-place": key,
          "aria-label": `Empty place, row ${place[0] + 1}, column ${place[1] + 1}: put a tile`,
        });
        this.spots.set(key, spot);
        this.root.prepend(spot);
      }
      move(spot, this.view.corner(...place));
    }
    for (const key of gone) {
      this.spots.get(key)?.remove();
      this.spots.delete(key);
    }
  }

  // --- by pointer ---

  /** A click that no pointer made: Enter, Space, or a screen reader. @param {MouseEvent} event */
  click(event) {
    if (event.detail !== 0) return;
    const target = /** @type {HTMLElement} */ (event.target).closest("button");
    const { port, place } = target?.dataset ?? {};
    if (port) this.deeds.select(port);
    else if (place) this.deeds.put(placeOf(place));
  }

  /** @param {string[]} ports @param {number} dx @param {number} dy @param {Place | "out" | null} target under the pointer */
  lift(ports, dx, dy, target) {
    if (!this.lifted.length) this.cables.flights = [];
    this.lifted = ports;
    this.wake();
    const held = this.tiles.laid().filter((tile) => ports.includes(tile.port));
    [dx, dy] = this.view.inWindow(held.map((tile) => tile.place), [dx, dy], this.root.getBoundingClientRect());
    this.cables.lift(ports, dx, dy);
    for (const port of ports) {
      const button = this.views.get(port)?.button;
      button?.classList.add("lifted");
      button?.style.setProperty("translate", `${dx}px ${dy}px`);
    }
    this.root.classList.add("holding");
    const isOut = target === "out";
    this.root.classList.toggle("out", isOut);
    const what = ports.length > 1 ? "them" : "it";
    const aims = target && !isOut ? this.landing(ports, target) : null;
    const box = byId("box");
    box.hidden = false;
    for (const [name, length] of Object.entries(this.view.outlet())) box.style.setProperty(name, `${length}px`);
    if (isOut) setText(box, `Let go to take ${what} out`);
    else setText(box, `${aims || !target ? "Drop" : "No room there; drop"} ${what} here to take ${what} out`);
    for (const [key, spot] of this.spots) spot.classList.toggle("aim", aims?.includes(key) ?? false);
  }

  /** Where tiles in the hand would land, "row,col"; null where others lie. @param {string[]} ports the first one is under the pointer @param {Place} place of the pointer */
  landing(ports, place) {
    const places = ports.map((port) => this.tiles.byPort.get(port)?.place ?? place);
    const [rows, cols] = [place[0] - places[0][0], place[1] - places[0][1]];
    if (!isFree(this.tiles, { ports, rows, cols })) return null;
    return places.map(([row, col]) => `${row + rows},${col + cols}`);
  }

  drop() {
    if (!this.lifted.length) return;
    for (const port of this.lifted) {
      const button = this.views.get(port)?.button;
      button?.classList.remove("lifted");
      button?.style.removeProperty("translate");
    }
    this.lifted = [];
    this.root.classList.remove("holding", "out");
    this.cables.lift([], 0, 0);
    byId("box").hidden = true;
    for (const spot of this.spots.values()) spot.classList.remove("aim");
  }

  // --- by keyboard ---

  /** @param {KeyboardEvent} event */
  key(event) {
    const side = ARROWS[event.key];
    const tile = this.tiles.at(...this.at);
    if (side !== undefined && event.shiftKey) {
      if (tile && this.tiles.neighbour(tile, side)) {
        this.deeds.cut(tile.port, SIDES[side], !this.tiles.isCut(tile, side));
      }
    } else if (side !== undefined && (event.ctrlKey || event.metaKey)) {
      if (!tile || !this.tiles.can("shift")) return;
      this.carry(tile, side);
    } else if (side !== undefined) {
      this.rove(this.next(side), true);
    } else if ((event.key === "Delete" || event.key === "Backspace") && tile) {
      this.deeds.pull(tile.port);
    } else if (event.key === "Escape" && this.selected) {
      this.deeds.select(null);
    } else {
      return;
    }
    event.preventDefault();
  }

  /** Moves all that hangs together with a tile by a place; the focus goes along. @param {Tile} tile @param {number} side */
  carry(tile, side) {
    const [rows, cols] = OFFSETS[side];
    const shift = { ports: clusterOf(this.tiles, tile).map(({ port }) => port), rows, cols };
    if (!isFree(this.tiles, shift)) {
      this.deeds.say("There is no room there for all that hangs together.");
      return;
    }
    this.deeds.shift(shift);
    this.at = [this.at[0] + rows, this.at[1] + cols];
  }

  /** The next place on a side; where none can be put in, the next tile there. @param {number} side @returns {Place} */
  next(side) {
    const [down, right] = OFFSETS[side];
    if (this.tiles.can("put")) return [this.at[0] + down, this.at[1] + right];
    /** @param {Place} place */
    const way = ([row, col]) => (row - this.at[0]) * down + (col - this.at[1]) * right;
    /** @param {Place} place */
    const far = ([row, col]) => Math.abs(row - this.at[0]) + Math.abs(col - this.at[1]);
    const ahead = this.tiles.laid().map((tile) => tile.place).filter((place) => way(place) > 0);
    return ahead.sort((one, other) => 2 * far(one) - way(one) - 2 * far(other) + way(other))[0] ?? this.at;
  }

  /** @param {FocusEvent} event */
  focused(event) {
    const { port, place } = /** @type {HTMLElement} */ (event.target).dataset;
    if (port) this.at = this.tiles.byPort.get(port)?.place ?? this.at;
    else if (place) this.at = placeOf(place);
    this.rove(this.at);
  }

  /** The button at a place. @param {Place} place */
  buttonAt(place) {
    const tile = this.tiles.at(...place);
    return tile ? this.views.get(tile.port)?.button : this.spots.get(place.join());
  }

  /** Makes Tab lead to a place, or to the nearest one in view. @param {Place} place @param {boolean} [focus] */
  rove(place, focus = false) {
    const [[top, left], [bottom, right]] = this.view.reach();
    const row = Math.max(top, Math.min(bottom, place[0]));
    const col = Math.max(left, Math.min(right, place[1]));
    for (const button of this.root.querySelectorAll("button[tabindex='0']")) button.setAttribute("tabindex", "-1");
    this.at = [row, col];
    const button = this.buttonAt(this.at) ?? this.views.values().next().value?.button;
    button?.setAttribute("tabindex", "0");
    if (focus) button?.focus({ preventScroll: true });
  }
}

/** @param {string} text "row,col" @returns {Place} */
function placeOf(text) {
  const [row, col] = text.split(",").map(Number);
  return [row, col];
}

/** @param {HTMLElement} one @param {[number, number]} to */
function move(one, [x, y]) {
  one.style.transform = `translate(${x}px, ${y}px)`;
}
