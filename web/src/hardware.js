// How far emulated boards differ from ideal ones, as `tilenca.emulator.hardware` says it.
import { seedOf } from "./checks.js";
import { TilencaError } from "./module.js";
import { Structure } from "./structures.js";

/** What a tile without power does to the inputs of its neighbours, in the order of the C interface. */
const UNPOWERED = ["low", "middle", "high", "open"];

export const HARDWARE = new Structure({
  seed: "u64", watchdog_error: "f64", floating_inputs: "i32", sram_noise: "i32", start_up: "i32", unpowered: "i32",
});

/**
 * The traits of an array's boards; each tile draws its own.
 * @typedef {object} Hardware
 * @property {number | bigint} [seed] decides all that is left to chance; default: 0
 * @property {boolean} [floatingInputs] an input that nobody drives reads noise; otherwise high
 * @property {boolean} [sramNoise] SRAM and registers hold noise at power-on; otherwise zeros
 * @property {number} [watchdogError] the watchdog's clock is off by a share of up to so much, 0 to 0.5
 * @property {"low" | "middle" | "high" | "open"} [unpowered] how a tile without power loads its neighbours' inputs
 * @property {boolean} [startUp] programs begin after the start-up time of the fuses; default: with a bootloader
 */

/** Boards as programs wish for them, for measurements that nothing shall disturb. @type {Hardware} */
export const IDEAL = {
  floatingInputs: false, sramNoise: false, watchdogError: 0, unpowered: "high", startUp: false,
};

/**
 * Writes it as the C interface takes it; what is not given is what a program has to live with.
 * @param {Uint8Array} memory of a structure
 * @param {Hardware} hardware
 * @param {boolean} hasBootloader
 */
export function writeHardware(memory, hardware, hasBootloader) {
  const {
    seed = 0, floatingInputs = true, sramNoise = true, watchdogError = 0.1, unpowered = "low", startUp = hasBootloader,
  } = hardware;
  if (!UNPOWERED.includes(unpowered)) {
    throw new TilencaError(`unpowered is '${unpowered}'; it is one of ${UNPOWERED.join(", ")}`);
  }
  HARDWARE.write(memory, {
    seed: seedOf(seed), watchdog_error: watchdogError, floating_inputs: Number(floatingInputs),
    sram_noise: Number(sramNoise), start_up: Number(startUp), unpowered: UNPOWERED.indexOf(unpowered),
  });
}
