// module.mjs MODULE FOLDER: the module of the browser page gives the same bytes as the command. FOLDER holds the inputs, and in
// `expected` what the command made of them.

import { readFileSync, readdirSync, statSync } from "node:fs";
import { join, relative } from "node:path";

import { answer } from "../../host-sim/browser/page/host.mjs";

const [path, folder] = process.argv.slice(2);
const module = await WebAssembly.compile(readFileSync(path));
const expected = (name) => readFileSync(join(folder, "expected", name), "utf8");

/** All files in a folder and its folders, as the page hands them over. */
function inFolder(name) {
  return readdirSync(join(folder, name), { recursive: true, withFileTypes: true })
    .filter((entry) => entry.isFile())
    .map((entry) => join(entry.parentPath, entry.name))
    .map((file) => ({ path: relative(folder, file), bytes: readFileSync(file), modified_ms: Math.floor(statSync(file).mtimeMs) }));
}

const file = (name) => ({ path: name, bytes: readFileSync(join(folder, name)), modified_ms: 0 });

async function ask(request, files) {
  const described = files.map(({ path, bytes, modified_ms }) => ({ path, size: bytes.length, modified_ms }));
  const readAt = (file, offset, count) => files[file].bytes.subarray(offset, offset + count);
  const messages = [];
  await answer(module, { files: described, request }, readAt, (message) => messages.push(message));
  return { ...messages.at(-1), messages };
}

function same(what, ours, theirs) {
  if (ours !== theirs) {
    console.error(`${what}: the module gives other bytes than the command (${ours?.length} and ${theirs.length})`);
    process.exitCode = 1;
  }
}

function folderIsSame(what, files, name) {
  const theirs = readdirSync(join(folder, name)).sort();
  same(`${what}: names of files`, files.map(([name]) => name).sort().join(" "), theirs.join(" "));
  for (const [file, text] of files) same(`${what}: ${file}`, text, readFileSync(join(folder, name, file), "utf8"));
}

const recorded = await ask({ command: "record", runs: 6, steps: 30, effects: ["drive_scale=0.8"], seed: 9 }, []);
folderIsSame("record", recorded.answer.files, "worn");

const trained = await ask({ command: "train", logs: "sound" }, inFolder("sound"));
same("train", trained.answer.files[0][1], readFileSync(join(folder, "simulator.json"), "utf8"));

const checked = await ask({ command: "check", logs: "worn" }, inFolder("worn"));
same("check: JSON", checked.answer.json, expected("check.json"));
same("check: text", checked.answer.text, expected("check.txt"));

const worn = [file("simulator.json"), ...inFolder("worn")];
const diagnosed = await ask({ command: "diagnose", simulator: "simulator.json", logs: ["worn"] }, worn);
same("diagnose: JSON", diagnosed.answer.json, expected("diagnosis.json"));
same("diagnose: text", diagnosed.answer.text, expected("diagnosis.txt"));
same("diagnose: page", diagnosed.answer.page, expected("diagnosis.html"));
if (!diagnosed.messages.some(({ progress }) => progress)) same("diagnose: progress", "none", "some");

const textbook = await ask({ command: "diagnose", simulator: null, logs: ["worn"] }, worn);
same("diagnose against the textbook: JSON", textbook.answer.json, expected("textbook.json"));

const table = { command: "import", are_bags: false, recordings: ["drive.csv"], robot: null, scene: null };
const imported = await ask(table, [file("drive.csv")]);
folderIsSame("import", imported.answer.files, "imported");

const missing = await ask({ command: "check", logs: "elsewhere" }, inFolder("worn"));
same("a missing folder", missing.error, "elsewhere/robot.toml: cannot be read: no such file");
