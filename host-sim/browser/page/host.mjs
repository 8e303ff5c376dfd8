// Runs the module: in a worker of the page, and in Node for tests.

/**
 * Answers one call. `module` is compiled; `call` has `files` (path, size, modified_ms) and `request`; `readAt(file, offset,
 * count)` returns bytes of a file by its number, none at its end; `report` takes each message.
 */
export async function answer(module, call, readAt, report) {
  let exports;
  // Memory may have grown since the last look at it.
  const bytes = (at, length) => new Uint8Array(exports.memory.buffer, at >>> 0, length >>> 0);
  const page = {
    read_at(file, offset, to, count) {
      const part = readAt(file, offset, count >>> 0);
      bytes(to, part.length).set(part);
      return part.length;
    },
    report(at, length) {
      report(JSON.parse(new TextDecoder().decode(bytes(at, length))));
    },
  };
  ({ exports } = await WebAssembly.instantiate(module, { page }));
  const text = new TextEncoder().encode(JSON.stringify(call));
  const room = exports.room(text.length);
  bytes(room, text.length).set(text);
  exports.run();
}
