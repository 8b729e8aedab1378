// Sides by their letters, and the ways to the neighbours there.
import { EAST, NORTH, SOUTH, WEST } from "../sides.js";

export const SIDES = "NESW";
/** Rows and columns from a tile to its neighbour on each side. */
export const OFFSETS = [[-1, 0], [0, 1], [1, 0], [0, -1]];
/** The side that faces a side. */
export const OPPOSITE = [SOUTH, WEST, NORTH, EAST];
