// Structures of a C header, as WebAssembly lays them out.

/** @typedef {"u8" | "i32" | "pointer" | "i64" | "u64" | "f64"} Type */

/** @type {Record<Type, number>} */
const BYTES = { u8: 1, i32: 4, pointer: 4, i64: 8, u64: 8, f64: 8 };

/** A structure, whose members lie one after the other, each at a multiple of its size. */
export class Structure {
  /** @type {Map<string, { type: Type, offset: number }>} */
  #members = new Map();
  bytes = 0;

  /** @param {Record<string, Type>} members in the order of the header */
  constructor(members) {
    let alignment = 1;
    for (const [name, type] of Object.entries(members)) {
      const size = BYTES[type];
      const offset = Math.ceil(this.bytes / size) * size;
      this.#members.set(name, { type, offset });
      this.bytes = offset + size;
      alignment = Math.max(alignment, size);
    }
    this.bytes = Math.ceil(this.bytes / alignment) * alignment;
  }

  /**
   * Writes all members; those that are not given are 0.
   * @param {Uint8Array} memory the structure's own bytes
   * @param {Record<string, number | bigint>} values
   */
  write(memory, values) {
    const view = new DataView(memory.buffer, memory.byteOffset, this.bytes);
    for (const [name, { type, offset }] of this.#members) {
      const value = values[name] ?? 0;
      if (type === "u8") {
        view.setUint8(offset, Number(value));
      } else if (type === "i32") {
        view.setInt32(offset, Number(value), true);
      } else if (type === "pointer") {
        view.setUint32(offset, Number(value), true);
      } else if (type === "f64") {
        view.setFloat64(offset, Number(value), true);
      } else {
        view.setBigInt64(offset, BigInt.asIntN(64, BigInt(value)), true);
      }
    }
  }
}
