// A WebAssembly module with one of the C libraries: its memory, and calls that throw.

/** A call that the library refused; the message is its one line: the thing, the fact, the remedy. */
export class TilencaError extends Error {
  name = "TilencaError";
}

/**
 * What may be loaded: an address, bytes, or a module that is compiled already.
 * @typedef {URL | string | BufferSource | WebAssembly.Module} Source
 */

/** @typedef {Record<string, (...args: (number | bigint)[]) => number>} Functions */

/**
 * Kinds of numbers in the module's memory.
 * @typedef {Int8Array | Uint8Array | Int16Array | Int32Array | Uint32Array | Float32Array | Float64Array |
 *   BigUint64Array} View
 */

/**
 * @template {View} V
 * @typedef {{ new (buffer: ArrayBufferLike, address: number, length: number): V, BYTES_PER_ELEMENT: number }} ViewOf
 */

const ALIGNMENT = 16;
const WASI_NO = 52; // "not here": what a function of WASI answers that nothing here needs

/**
 * Compiles a source; an address is read from the disk under node, and fetched elsewhere.
 * @param {Source} source
 * @returns {Promise<WebAssembly.Module>}
 */
async function compiled(source) {
  if (source instanceof WebAssembly.Module) {
    return source;
  }
  if (!(source instanceof URL) && typeof source !== "string") {
    return WebAssembly.compile(source);
  }
  const address = new URL(source, import.meta.url);
  if (address.protocol === "file:") {
    const { readFile } = await import("node:fs/promises");
    return WebAssembly.compile(/** @type {Uint8Array<ArrayBuffer>} */ (await readFile(address)));
  }
  const response = await fetch(address);
  if (!response.ok) {
    throw new TilencaError(`${address}: ${response.status} ${response.statusText}; serve the whole bundle`);
  }
  if (response.headers.get("content-type") === "application/wasm") {
    return WebAssembly.compileStreaming(response); // while it comes; not every server of files names the type
  }
  return WebAssembly.compile(await response.arrayBuffer());
}

/** An instance of a module, with memory of its own. */
export class Module {
  /** @type {WebAssembly.Memory} */
  #memory;
  /** @type {Functions} */
  #functions;
  /** @type {Map<string, Uint8Array>} */
  #files = new Map();
  #prefix;
  #scratch = 0;
  #scratchBytes = 0;
  #used = 0;

  /**
   * @param {Source} source
   * @param {string} name of the library, "emulator" or "simulator"
   * @param {number} version of the C interface that the caller was written for
   * @param {Record<string, number>} structures the bytes of its structures, as the caller knows them
   */
  static async load(source, name, version, structures) {
    const module = await compiled(source);
    /** @type {Module | undefined} */
    let made;
    const imports = {
      files: {
        size: (/** @type {number} */ path, /** @type {number} */ length) =>
          made?.file(path, length)?.length ?? -1,
        read: (/** @type {number} */ path, /** @type {number} */ length, /** @type {number} */ to) => {
          made?.bytes(to).set(made.file(path, length) ?? []);
        },
      },
      env: { emscripten_notify_memory_growth: () => {} },
      wasi_snapshot_preview1: {
        clock_time_get: () => WASI_NO,
        environ_get: () => WASI_NO,
        environ_sizes_get: () => WASI_NO,
        proc_exit: (/** @type {number} */ status) => {
          throw new TilencaError(`the ${name} ended with status ${status}; load it anew`);
        },
      },
    };
    const { exports } = await WebAssembly.instantiate(module, imports);
    made = new Module(exports, name);
    const found = made.call("abi_version");
    const wrong = Object.entries(structures).find(
      ([structure, bytes]) => made?.call("size_of", made.string(structure)) !== bytes,
    );
    if (found !== version || wrong !== undefined) {
      throw new TilencaError(
        `the ${name} has version ${found}, and this face is for ${version}, or another ${wrong?.[0] ?? "structure"}; ` +
          "run `make web` again",
      );
    }
    return made;
  }

  /**
   * @param {WebAssembly.Exports} exports
   * @param {string} name
   */
  constructor(exports, name) {
    this.#memory = /** @type {WebAssembly.Memory} */ (exports.memory);
    this.#functions = /** @type {Functions} */ (/** @type {unknown} */ (exports));
    this.#prefix = `tilenca_${name}_`;
    this.#functions._initialize();
  }

  /**
   * Lets the library find these bytes under a name.
   * @param {string} path
   * @param {Uint8Array} bytes copied
   */
  putFile(path, bytes) {
    this.#files.set(path, bytes.slice());
  }

  /** @param {string} path */
  dropFile(path) {
    this.#files.delete(path);
  }

  /**
   * @param {number} address
   * @param {number} length
   */
  file(address, length) {
    return this.#files.get(new TextDecoder().decode(this.bytes(address, length)));
  }

  /**
   * Calls tilenca_NAME, or tilenca_LIBRARY_NAME if that is one of the library's own.
   * @param {string} name
   * @param {...(number | bigint)} args
   * @returns {number} what it returned
   * @throws {TilencaError} it returned a number below 0
   */
  call(name, ...args) {
    const result = this.#function(name)(...args);
    if (result < 0) {
      throw this.#refusal();
    }
    return result;
  }

  /**
   * Calls a function whose result is an address.
   * @param {string} name
   * @param {...(number | bigint)} args
   * @throws {TilencaError} it returned null
   */
  address(name, ...args) {
    const result = this.#function(name)(...args);
    if (result === 0) {
      throw this.#refusal();
    }
    return result >>> 0;
  }

  /** @param {string} name */
  #function(name) {
    const found = this.#functions[`tilenca_${name}`] ?? this.#functions[this.#prefix + name];
    if (found === undefined) {
      throw new TilencaError(`this module has no function ${name}; run \`make web\` again`);
    }
    return found;
  }

  #refusal() {
    return new TilencaError(this.text(this.#functions[`${this.#prefix}last_error`]()));
  }

  /**
   * The text at an address.
   * @param {number} address
   */
  text(address) {
    const bytes = this.bytes(address);
    return new TextDecoder().decode(bytes.slice(0, bytes.indexOf(0)));
  }

  /**
   * The memory from an address on; valid until it grows, which any call may do.
   * @param {number} address
   * @param {number} [length] default: all the rest
   */
  bytes(address, length) {
    return new Uint8Array(this.#memory.buffer, address, length);
  }

  /**
   * Numbers at an address; valid until the memory grows, which any call may do.
   * @template {View} V
   * @param {ViewOf<V>} kind
   * @param {number} address
   * @param {number} length in numbers
   * @returns {V}
   */
  view(kind, address, length) {
    return new kind(this.#memory.buffer, address, length);
  }

  /**
   * Memory that stays until it is freed.
   * @param {number} bytes
   */
  allocate(bytes) {
    const address = this.#functions.malloc(Math.max(1, bytes));
    if (address === 0) {
      throw new TilencaError(`out of memory: ${bytes} bytes more are not to be had`);
    }
    return address >>> 0;
  }

  /** @param {number} address of `allocate` */
  free(address) {
    this.#functions.free(address);
  }

  /**
   * Room for the arguments and results of one call, which lasts until the next `begin`.
   * @param {number} bytes of all pieces together, each with up to 15 of padding
   */
  begin(bytes) {
    if (bytes > this.#scratchBytes) {
      this.free(this.#scratch);
      const room = Math.max(2 * this.#scratchBytes, bytes, 4096);
      [this.#scratch, this.#scratchBytes] = [0, 0]; // it may be that there is no more
      this.#scratch = this.allocate(room);
      this.#scratchBytes = room;
    }
    this.#used = 0;
  }

  /**
   * A piece of that room.
   * @param {number} bytes
   * @returns {number} its address, a multiple of 16
   */
  take(bytes) {
    const address = this.#scratch + this.#used;
    this.#used += Math.ceil(bytes / ALIGNMENT) * ALIGNMENT;
    return address;
  }

  /**
   * One text as the only argument of its kind.
   * @param {string} text
   * @returns {number} its address, until the next `begin`
   */
  string(text) {
    const bytes = new TextEncoder().encode(`${text}\0`);
    this.begin(bytes.length + ALIGNMENT);
    const address = this.take(bytes.length);
    this.bytes(address).set(bytes);
    return address;
  }
}
