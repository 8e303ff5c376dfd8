// Unpacks ZIP archives.

import { run } from "./progress.mjs";

/** The files with those of archives among them in place of the archives. Progress and errors are shown in `place`. */
export async function unpacked(files, place) {
  const all = [];
  for (const file of files) {
    if (!file.path.toLowerCase().endsWith(".zip")) {
      all.push(file);
      continue;
    }
    const answer = await run(place, `Unpacking ${file.path}`, { command: "archive", path: file.path }, [file]);
    for (const entry of answer ? JSON.parse(answer.json) : []) all.push(await inArchive(file, entry));
  }
  return all;
}

async function inArchive({ blob, modified_ms }, { path, range, is_deflated }) {
  const packed = blob.slice(...range);
  if (!is_deflated) return { path, blob: packed, modified_ms };
  const plain = packed.stream().pipeThrough(new DecompressionStream("deflate-raw"));
  return { path, blob: await new Response(plain).blob(), modified_ms };
}
