// Writes GIFs (version 89a): one palette for all frames, and of each frame only what is new.

const CLEAR = 256;
const END = 257;
const MOST_CODES = 4096;
const MOST_BLOCK = 255; // bytes
const SAME = 255; // the entry of the palette for a pixel that stays as it was
export const MOST_COLOURS = 255;

/** @param {number} number @returns {number[]} */
const two = (number) => [number & 0xff, number >> 8];

/** Codes of 9 to 12 bits (LZW), in blocks. */
class Codes {
  /** @type {number[]} */
  bytes = [];
  #held = 0;
  #count = 0;

  /** @param {number} code @param {number} bits */
  put(code, bits) {
    this.#held |= code << this.#count;
    for (this.#count += bits; this.#count >= 8; this.#count -= 8, this.#held >>>= 8) this.bytes.push(this.#held & 0xff);
  }

  /** All bytes in blocks, each after its length, and an empty one. */
  blocks() {
    if (this.#count) this.bytes.push(this.#held & 0xff);
    const blocks = [];
    for (let at = 0; at < this.bytes.length; at += MOST_BLOCK) {
      const block = this.bytes.slice(at, at + MOST_BLOCK);
      blocks.push(block.length, ...block);
    }
    return [...blocks, 0];
  }
}

/** Pixels of at least one, packed. @param {Uint8Array} pixels */
function packed(pixels) {
  const codes = new Codes();
  /** The code of a known sequence and a pixel after it. @type {Map<number, number>} */
  const known = new Map();
  let bits = 9;
  let next = END + 1;
  codes.put(CLEAR, bits);
  let prefix = pixels[0];
  for (let at = 1; at < pixels.length; at++) {
    const key = (prefix << 8) | pixels[at];
    const code = known.get(key);
    if (code !== undefined) {
      prefix = code;
      continue;
    }
    codes.put(prefix, bits);
    prefix = pixels[at];
    if (next < MOST_CODES) {
      known.set(key, next);
      if (next++ === 1 << bits && bits < 12) bits++;
    } else {
      codes.put(CLEAR, bits);
      known.clear();
      bits = 9;
      next = END + 1;
    }
  }
  codes.put(prefix, bits);
  codes.put(END, bits);
  return [8, ...codes.blocks()];
}

export class Gif {
  /** @type {Uint8Array | null} */
  #last = null;
  /** @type {{pixels: Uint8Array, box: number[], centiseconds: number} | null} */
  #held = null;

  /** @param {number} width @param {number} height @param {number[][]} palette at most MOST_COLOURS of red, green and blue */
  constructor(width, height, palette) {
    this.width = width;
    this.height = height;
    const table = Array.from({ length: 256 }, (_, index) => palette[index] ?? [0, 0, 0]);
    /** @type {Uint8Array[]} */
    this.parts = [Uint8Array.from([
      ...new TextEncoder().encode("GIF89a"), ...two(width), ...two(height), 0xf7, 0, 0, ...table.flat(),
      0x21, 0xff, 11, ...new TextEncoder().encode("NETSCAPE2.0"), 3, 1, 0, 0, 0, // for ever
    ])];
  }

  /** A frame that stands so long; where nothing is new, the one before stands longer. @param {Uint8Array} pixels entries of the palette, row by row @param {number} centiseconds */
  add(pixels, centiseconds) {
    const box = this.#newBox(pixels);
    if (!box && this.#held) {
      this.#held.centiseconds += centiseconds;
      return;
    }
    this.#write();
    const [left, top, width, height] = box ?? [0, 0, 1, 1];
    const part = new Uint8Array(width * height);
    for (let y = 0; y < height; y++) {
      for (let x = 0; x < width; x++) {
        const at = (top + y) * this.width + left + x;
        part[y * width + x] = this.#last && this.#last[at] === pixels[at] ? SAME : pixels[at];
      }
    }
    this.#held = { pixels: part, box: [left, top, width, height], centiseconds };
    this.#last = pixels.slice();
  }

  /** The box of the pixels that are new; null: none is. @param {Uint8Array} pixels */
  #newBox(pixels) {
    const last = this.#last;
    if (!last) return [0, 0, this.width, this.height];
    let [left, top, right, bottom] = [this.width, this.height, -1, -1];
    for (let y = 0, at = 0; y < this.height; y++) {
      for (let x = 0; x < this.width; x++, at++) {
        if (pixels[at] === last[at]) continue;
        if (x < left) left = x;
        if (x > right) right = x;
        if (y < top) top = y;
        bottom = y;
      }
    }
    return right < 0 ? null : [left, top, right - left + 1, bottom - top + 1];
  }

  #write() {
    if (!this.#held) return;
    const { pixels, box, centiseconds } = this.#held;
    const isLater = this.parts.length > 1;
    this.parts.push(Uint8Array.from([
      0x21, 0xf9, 4, isLater ? 0x05 : 0x04, ...two(Math.min(centiseconds, 0xffff)), SAME, 0,
      0x2c, ...box.flatMap(two), 0, ...packed(pixels),
    ]));
    this.#held = null;
  }

  /** The file; nothing can be added afterwards. */
  blob() {
    this.#write();
    this.parts.push(Uint8Array.of(0x3b));
    return new Blob(/** @type {BlobPart[]} */ (this.parts), { type: "image/gif" });
  }
}

/** Colours of pictures, in 32 steps of each part. */
export class Colours {
  #counts = new Uint32Array(1 << 15);
  /** Of each of these colours the entry of the palette, and one more; 0: not looked for yet. */
  #entries = new Uint16Array(1 << 15);
  /** @type {number[][]} */
  palette = [];

  /** Counts those of a picture. @param {Uint8ClampedArray} rgba */
  count(rgba) {
    for (let at = 0; at < rgba.length; at += 4) this.#counts[key(rgba, at)]++;
  }

  /** Makes the palette: splits the box of all colours where it is longest, and takes the middle of each part. @param {number} [most] */
  choose(most = MOST_COLOURS) {
    /** @type {number[][]} */
    const all = [];
    this.#counts.forEach((count, one) => {
      if (count) all.push([one >> 10, (one >> 5) & 31, one & 31, count]);
    });
    const boxes = [all];
    while (boxes.length < Math.min(most, all.length)) {
      const [index, axis] = longest(boxes);
      const box = boxes[index].sort((one, other) => one[axis] - other[axis]);
      const half = box.reduce((sum, [, , , count]) => sum + count, 0) / 2;
      let sum = 0;
      const middle = box.findIndex(([, , , count]) => (sum += count) >= half);
      const at = Math.min(Math.max(middle, 1), box.length - 1);
      boxes.splice(index, 1, box.slice(0, at), box.slice(at));
    }
    this.palette = boxes.map((box) => {
      const total = box.reduce((sum, [, , , count]) => sum + count, 0);
      return [0, 1, 2].map((axis) => Math.round((255 / 31) * (box.reduce((sum, one) => sum + one[axis] * one[3], 0) / total)));
    });
  }

  /** The nearest entries of the palette for a picture. @param {Uint8ClampedArray} rgba */
  entries(rgba) {
    const found = new Uint8Array(rgba.length / 4);
    for (let at = 0; at < rgba.length; at += 4) {
      const one = key(rgba, at);
      this.#entries[one] ||= this.#nearest(one) + 1;
      found[at / 4] = this.#entries[one] - 1;
    }
    return found;
  }

  /** @param {number} one */
  #nearest(one) {
    const wanted = [one >> 10, (one >> 5) & 31, one & 31].map((part) => (part * 255) / 31);
    const far = this.palette.map((colour) => colour.reduce((sum, part, axis) => sum + (part - wanted[axis]) ** 2, 0));
    return far.indexOf(Math.min(...far));
  }
}

/** @param {Uint8ClampedArray} rgba @param {number} at */
const key = (rgba, at) => ((rgba[at] >> 3) << 10) | ((rgba[at + 1] >> 3) << 5) | (rgba[at + 2] >> 3);

/** The box that is longest, and along which part. @param {number[][][]} boxes */
function longest(boxes) {
  let best = [0, 0, -1];
  boxes.forEach((box, index) => {
    for (const axis of [0, 1, 2]) {
      let [low, high] = [31, 0];
      for (const one of box) [low, high] = [Math.min(low, one[axis]), Math.max(high, one[axis])];
      if (high - low > best[2]) best = [index, axis, high - low];
    }
  });
  return best;
}
