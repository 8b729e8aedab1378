// What other programs use.
export { TileArray } from "./array.js";
export { linksOf, neighboursOf, tilesOf } from "./drawing.js";
export { Emulator } from "./emulator.js";
export { IDEAL } from "./hardware.js";
export { TilencaError } from "./module.js";
export { Probe } from "./probe.js";
export { EAST, NORTH, SOUTH, WEST } from "./sides.js";
export { Tile } from "./tile.js";
export { RemoteArray } from "./remote.js";
export { Network, Simulator } from "./simulator.js";
export { GridBatch } from "./batch.js";
