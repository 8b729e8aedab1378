// The sides of a tile, as the C interface counts them.
export const NORTH = 0;
export const EAST = 1;
export const SOUTH = 2;
export const WEST = 3;
