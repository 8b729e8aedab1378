// One emulated tile, as eyes, fingers and cables reach it.
import { indexBelow, pinOf, seedOf, whole } from "./checks.js";
import { Probe } from "./probe.js";

const CHUNK = 4096;
const MOST_TILES = 4096;

/** @typedef {import("./module.js").View} View */

/** A tile of an array, made by `TileArray.tile`. Lists that it returns are views: they last until the next call. */
export class Tile {
  /**
   * @param {import("./array.js").TileArray} array
   * @param {number} index
   */
  constructor(array, index) {
    this.array = array;
    this.index = index;
  }

  /**
   * @param {string} name
   * @param {...(number | bigint)} args
   */
  #call(name, ...args) {
    return this.array.module.call(`tile_${name}`, this.array.handle, this.index, ...args);
  }

  /** The lit segments: bit 0 = a ... bit 6 = g, bit 7 = dp. */
  get segments() {
    return this.#call("segments");
  }

  /** The debug LEDs: bit 0 to 3 = N E S W. */
  get leds() {
    return this.#call("leds");
  }

  /** Duty of red, green and blue, 0 to 255 each. */
  get rgb() {
    const { module } = this.array;
    module.begin(3);
    const duty = module.take(3);
    this.#call("rgb", duty);
    return module.bytes(duty, 3);
  }

  /** How often the display has changed. */
  get displayChangesCount() {
    return this.#call("display_changes", 0, 0, 0, 0);
  }

  /**
   * What the display has shown, and when, in seconds.
   * @param {number} [first] the first change that is wanted
   */
  displayChanges(first = 0) {
    const room = Math.max(0, this.displayChangesCount - whole("the first change", first));
    return this.#lists(room, Float64Array, Uint8Array, (times, segments) =>
      Math.min(room, this.#call("display_changes", Math.max(0, first), times, segments, room)),
    );
  }

  /**
   * Two lists that the library fills.
   * @template {View} First
   * @template {View} Second
   * @param {number} room of each
   * @param {import("./module.js").ViewOf<First>} first
   * @param {import("./module.js").ViewOf<Second>} second
   * @param {(first: number, second: number) => number} fill returns how many there are
   */
  #lists(room, first, second, fill) {
    const { module } = this.array;
    const sizes = [room * first.BYTES_PER_ELEMENT, room * second.BYTES_PER_ELEMENT];
    module.begin(sizes[0] + sizes[1] + 32);
    const [one, two] = [module.take(sizes[0]), module.take(sizes[1])];
    const count = fill(one, two);
    return { times: module.view(first, one, count), values: module.view(second, two, count) };
  }

  /** What stopped the tile, or "" while it runs. */
  get fault() {
    const { module, handle } = this.array;
    return module.text(module.address("tile_fault", handle, this.index));
  }

  /** Functions of the chip that the program asked for and that are not modelled, each once. */
  get warnings() {
    const { module, handle } = this.array;
    return Array.from({ length: this.#call("warnings") }, (_, index) =>
      module.text(module.address("tile_warning", handle, this.index, index)),
    );
  }

  /** Clock cycles of the time it was switched on: in all, and asleep. */
  get cycles() {
    const { module } = this.array;
    module.begin(24);
    const address = module.take(24);
    this.#call("cycles", address);
    const [total, asleep, off] = Array.from(module.view(BigUint64Array, address, 3), Number);
    return { total: total - off, asleep };
  }

  /** Whether it has power. Switched on again it starts as new, but for flash, EEPROM and fuses. */
  get powered() {
    return this.#call("is_powered") === 1;
  }

  set powered(on) {
    this.#call("set_power", Number(on));
  }

  /** Holds the push button down, or lets it go. @param {boolean} [pressed] */
  pressButton(pressed = true) {
    this.#call("press_button", Number(pressed));
  }

  /**
   * Resets the chip from outside.
   * @param {"external" | "brown-out"} [cause]
   */
  reset(cause = "external") {
    this.#call("reset", cause === "external" ? 2 : 4);
  }

  /** From now on the clock error grows by so much a second. @param {number} ppmPerS */
  setDrift(ppmPerS) {
    this.#call("set_drift", ppmPerS);
  }

  /** From now on the clock is so much faster than it would be. @param {number} ppm */
  setSkew(ppm) {
    this.#call("set_skew", ppm);
  }

  // --- USB ---

  /**
   * Queues bytes for its USB serial; they arrive while the array runs, at the tile's speed.
   * @param {Uint8Array | string} data
   */
  send(data) {
    const bytes = typeof data === "string" ? new TextEncoder().encode(data) : data;
    this.#give(bytes, (address) => this.#call("send", address, bytes.length));
  }

  /**
   * What it has sent on USB since the last call, and when each byte had arrived: at most 4096 bytes at a time.
   */
  receive() {
    return this.#lists(CHUNK, Float64Array, Uint8Array, (times, values) => this.#call("receive", values, times, CHUNK));
  }

  /** All that it has sent on USB since the last call, as text. */
  readSerial() {
    let text = "";
    for (let { values } = this.receive(); values.length > 0; { values } = this.receive()) {
      text += String.fromCharCode(...values);
    }
    return text;
  }

  // --- memories ---

  /**
   * @param {number} address
   * @param {number} count
   */
  readEeprom(address, count) {
    return this.#read("read_eeprom", address, count);
  }

  /**
   * Puts bytes into the EEPROM at once, as a programmer does.
   * @param {number} address
   * @param {Uint8Array} bytes
   */
  writeEeprom(address, bytes) {
    whole("the address", address);
    this.#give(bytes, (from) => this.#call("write_eeprom", address, from, bytes.length));
  }

  /**
   * The data space as stored: registers, I/O from 0x20, SRAM from 0x200.
   * @param {number} address
   * @param {number} count
   */
  readMemory(address, count) {
    return this.#read("read_memory", address, count);
  }

  /**
   * @param {number} address in bytes
   * @param {number} count
   */
  readFlash(address, count) {
    return this.#read("read_flash", address, count);
  }

  /**
   * @param {string} name
   * @param {number} address
   * @param {number} count
   */
  #read(name, address, count) {
    const { module } = this.array;
    const bytes = Math.max(0, whole("the number of bytes", count));
    module.begin(bytes);
    const place = module.take(bytes);
    this.#call(name, whole("the address", address), place, count);
    return module.bytes(place, bytes);
  }

  /**
   * @param {Uint8Array} bytes
   * @param {(address: number) => void} use
   */
  #give(bytes, use) {
    const { module } = this.array;
    module.begin(bytes.length);
    const address = module.take(bytes.length);
    module.bytes(address).set(bytes);
    use(address);
  }

  // --- pins ---

  /**
   * The level of a pin, such as `pin("K", 7)`.
   * @param {string} port
   * @param {number} bit
   */
  pin(port, bit) {
    return this.#call("pin", ...pinOf(port, bit)) === 1;
  }

  /**
   * Drives an input from outside.
   * @param {string} port
   * @param {number} bit
   * @param {boolean} level
   */
  holdPin(port, bit, level) {
    this.#call("hold_pin", ...pinOf(port, bit), Number(level));
  }

  /**
   * What an analog input converts to.
   * @param {number} channel 0 to 15
   * @param {number} value 0 to 1023
   */
  setAnalog(channel, value) {
    this.#call("set_analog", indexBelow("analog input", channel, 16), whole("the value", value));
  }

  /**
   * The supply voltage, as the ADC sees it beside the bandgap's 1.1 V.
   * @param {number} volts 1.8 to 5.5
   */
  setSupply(volts) {
    this.#call("set_supply", volts);
  }

  /**
   * Conversions are off by a normal deviate, in units of the result's lowest bit.
   * @param {number} deviation
   * @param {number | bigint} [seed] as in `tilenca.emulator`
   */
  setAdcNoise(deviation, seed = 0) {
    const number = seedOf(seed) * BigInt(MOST_TILES) + BigInt(this.index);
    this.#call("set_adc_noise", deviation, BigInt.asUintN(64, number));
  }

  /**
   * Looks at a pin from now on.
   * @param {string} port
   * @param {number} bit
   */
  probe(port, bit) {
    return new Probe(this, port, bit, -1);
  }

  /**
   * Reads the bytes on a side's wire from now on.
   * @param {number} side
   * @param {{ baud?: number, receiving?: boolean }} [options] `baud`: default as the USART of that pin is set;
   *   `receiving`: the wire that arrives instead of the one that leaves
   */
  tap(side, { baud = 0, receiving = false } = {}) {
    const { module } = this.array;
    module.begin(32);
    const [port, bit] = [module.take(1), module.take(4)];
    module.call("side_pin", indexBelow("side", side, 4), Number(receiving), port, bit);
    const letter = String.fromCharCode(module.bytes(port)[0]);
    return new Probe(this, letter, module.view(Uint32Array, bit, 1)[0], baud);
  }
}
