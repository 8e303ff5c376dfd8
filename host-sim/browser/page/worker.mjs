// The worker: one call, then the page ends it.

import { answer } from "./host.mjs";

// The module asks for 64 KiB at a time.
const BLOCK_BYTES = 4 << 20;

self.onmessage = async ({ data: { module, files, request } }) => {
  const reader = new FileReaderSync();
  let block;
  let [blockFile, blockStart] = [-1, 0];
  const readAt = (file, offset, count) => {
    const { blob } = files[file];
    if (offset >= blob.size) return new Uint8Array();
    if (blockFile !== file || offset < blockStart || offset >= blockStart + block.length) {
      block = new Uint8Array(reader.readAsArrayBuffer(blob.slice(offset, offset + BLOCK_BYTES)));
      [blockFile, blockStart] = [file, offset];
    }
    return block.subarray(offset - blockStart, offset - blockStart + count);
  };
  const described = files.map(({ path, blob, modified_ms }) => ({ path, size: blob.size, modified_ms }));
  try {
    await answer(module, { files: described, request }, readAt, (message) => postMessage(message));
  } catch (why) {
    postMessage({ error: `the work ended early: ${why.message}` });
  }
};
