// What files are, by their names and first bytes.

const folderOf = (path) => path.slice(0, Math.max(path.lastIndexOf("/"), 0));
const nameOf = (path) => path.slice(path.lastIndexOf("/") + 1);

/**
 * Sorts files: `logs` are folders with a robot and runs, `simulators`, `bags` and `tables` are paths, and so are `robot` and
 * `scene`, which belong to recordings; `others` were not recognised.
 */
export async function recognise(files) {
  const found = { logs: [], simulators: [], bags: [], tables: [], robot: null, scene: null, others: [] };
  const paths = files.map(({ path }) => path);
  const runs = (folder) => paths.filter((path) => folderOf(path) === folder && /^run-.*\.csv$/.test(nameOf(path)));
  for (const path of paths.filter((path) => nameOf(path) === "robot.toml")) {
    const folder = folderOf(path);
    if (runs(folder).length > 0) found.logs.push({ folder, runs: runs(folder).length });
    else found.robot = path;
  }
  const isInLogs = (path) => found.logs.some(({ folder }) => folder === folderOf(path));
  for (const { path, blob } of files.filter(({ path }) => !isInLogs(path) && path !== found.robot)) {
    const name = nameOf(path).toLowerCase();
    if (name === "scene.toml") found.scene = path;
    else if (/\.(mcap|db3|bag)(\.zstd)?$/.test(name)) found.bags.push(bagOf(path, paths));
    else if (/\.(csv|tsv|tum|txt)(\.gz)?$/.test(name)) found.tables.push(path);
    else if (/\.json$/.test(name) && (await isSimulator(blob))) found.simulators.push(path);
    else if (name !== "metadata.yaml") found.others.push(path);
  }
  return { ...found, bags: [...new Set(found.bags)] };
}

/** The folder of a bag, which a description names as such, or its file. */
function bagOf(path, paths) {
  return paths.includes(`${folderOf(path)}/metadata.yaml`) ? folderOf(path) : path;
}

async function isSimulator(blob) {
  const start = await blob.slice(0, 4096).text();
  return /"schema"/.test(start) && /"robot"/.test(start);
}
