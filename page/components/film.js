// A part of a run as a GIF: the recorded events once more, and a picture of the board for each frame.

/** @import { Lens } from "../stream/lens.js" */
/** @import { Place, StreamEvent } from "../stream/source.js" */
import { Tiles } from "../stream/tiles.js";
import { Colours, Gif } from "./gif.js";
import { boxOf, paintBoard } from "./picture.js";
import { verdictOn } from "./verdict.js";

const FRAMES_PER_S = 12.5; // GIFs count in hundredths of a second
const LAST_S = 1.5; // the last frame stands so long
const SAMPLES = 8; // frames whose colours the palette is made of
const PORTION = 2000; // events between two breaths
const TELL_MS = 1000; // between two words on how long it takes
const SIZE = 64; // pixels of a tile's place

/** The times of the frames, in seconds of the run. @param {{from: number, to: number, seconds: number}} span what of the run, and how long it is to last */
export function frameTimes({ from, to, seconds }) {
  const count = Math.max(1, Math.round(seconds * FRAMES_PER_S));
  return Array.from({ length: count + 1 }, (_, index) => from + ((to - from) * index) / count);
}

/** Lets the browser paint. */
const breath = () => new Promise((resolve) => setTimeout(resolve, 0));

/**
 * The tiles at some times: the same ones, as they are then.
 * @param {StreamEvent[]} recorded in order of time
 * @param {number[]} times
 */
async function* tilesAt(recorded, times) {
  const tiles = new Tiles();
  let place = 0;
  for (const time of times) {
    let end = place;
    while (end < recorded.length && (end === 0 || recorded[end].time <= time)) end++;
    for (; place < end; place += PORTION) {
      tiles.take(recorded.slice(place, Math.min(end, place + PORTION)));
      await breath();
    }
    place = end;
    tiles.time = time;
    yield tiles;
  }
}

/**
 * @param {StreamEvent[]} recorded of `Recorder.recording`
 * @param {{from: number, to: number, seconds: number}} span
 * @param {Lens | null} lens
 * @param {(left: number) => void} tell the seconds that it will still take, about once a second
 * @returns {Promise<Blob>}
 */
export async function boardFilm(recorded, span, lens, tell = () => {}) {
  const times = frameTimes(span);
  /** @type {Place[]} */
  const places = [];
  for await (const tiles of tilesAt(recorded, times)) places.push(...tiles.laid().map((tile) => tile.place));
  const box = boxOf(places);
  const canvas = document.createElement("canvas");
  /** @param {Tiles} tiles */
  const picture = (tiles) => {
    const words = `${verdictOn(tiles).text}, ${tiles.time.toFixed(2)} s`;
    paintBoard(canvas, tiles, { words, lens, box, size: SIZE });
    const pen = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
    return pen.getImageData(0, 0, canvas.width, canvas.height).data;
  };
  const colours = new Colours();
  const every = Math.max(1, Math.floor(times.length / SAMPLES));
  for await (const tiles of tilesAt(recorded, times.filter((_, index) => (times.length - 1 - index) % every === 0))) {
    colours.count(picture(tiles));
    await breath();
  }
  colours.choose();
  const gif = new Gif(canvas.width, canvas.height, colours.palette);
  let left = times.length;
  const began = performance.now();
  let told = began;
  for await (const tiles of tilesAt(recorded, times)) {
    gif.add(colours.entries(picture(tiles)), --left ? 100 / FRAMES_PER_S : 100 * LAST_S);
    const now = performance.now();
    if (now - told > TELL_MS) {
      told = now;
      tell(((now - began) / 1000) * (left / (times.length - left)));
    }
    await breath();
  }
  return gif.blob();
}
