// Files that are dropped or chosen, each as { path, blob, modified_ms }.

/** The files of a drop, with all folders in it. */
export async function dropped(transfer) {
  // The list of items is empty after the first wait.
  const entries = [...transfer.items].map((item) => item.webkitGetAsEntry()).filter(Boolean);
  return inFolder((await Promise.all(entries.map(inEntry))).flat());
}

/** The files of an input, which is then ready to take the same ones again. */
export function chosen(input) {
  const files = [...input.files].map((file) => named(file, file.webkitRelativePath || file.name));
  input.value = "";
  return inFolder(files);
}

/** A file that the page made. */
export function made(path, text) {
  return { path, blob: new Blob([text]), modified_ms: Date.now() };
}

/** Files of logs without a folder, as if they came in one. */
function inFolder(files) {
  const isOwn = ({ path }) => /^(robot|scene|session)\.toml$|^(run|commands)-.*\.csv$/.test(path);
  const are_logs = files.some(({ path }) => path === "robot.toml") && files.some(({ path }) => /^run-.*\.csv$/.test(path));
  return are_logs ? files.map((file) => (isOwn(file) ? { ...file, path: `logs/${file.path}` } : file)) : files;
}

const named = (file, path) => ({ path, blob: file, modified_ms: file.lastModified });

async function inEntry(entry) {
  if (entry.isFile) {
    const file = await new Promise((resolve, reject) => entry.file(resolve, reject));
    return [named(file, entry.fullPath.slice(1))];
  }
  const reader = entry.createReader();
  const files = [];
  // A folder comes in batches; an empty one is the last.
  for (;;) {
    const batch = await new Promise((resolve, reject) => reader.readEntries(resolve, reject));
    if (batch.length === 0) return files;
    files.push(...(await Promise.all(batch.map(inEntry))).flat());
  }
}
