// The page: takes files, says what they are, checks logs, and offers what can be done with them.

import { chosen, dropped } from "./accept.mjs";
import { check } from "./check.mjs";
import { diagnosing } from "./diagnose.mjs";
import { list, make } from "./elements.mjs";
import { importing } from "./import.mjs";
import { playground } from "./playground.mjs";
import { run } from "./progress.mjs";
import { recognise } from "./recognise.mjs";
import { unpacked } from "./zip.mjs";

const part = (id) => document.getElementById(id);
/** All files so far, by path. */
let held = new Map();
/** How often everything was shown; a newer turn ends those before it. */
let turns = 0;
/** The recordings, robot and scene that the form of imports is for. */
let importedFrom = null;

async function take(files) {
  (await unpacked(files, part("taking"))).forEach((file) => held.set(file.path, file));
  await show();
}

/** Shows everything about the files, from recognition on. */
async function show() {
  const turn = ++turns;
  const files = [...held.values()];
  const found = await recognise(files);
  if (turn !== turns) return;
  const { logs, simulators, bags, tables, others } = found;
  const recordings = bags.length > 0 ? bags : tables;
  part("recognised").replaceChildren(
    list([
      ...logs.map(({ folder, runs }) => `${folder}: logs, ${runs} run${runs === 1 ? "" : "s"}`),
      ...simulators.map((path) => `${path}: a simulator`),
      ...bags.map((path) => `${path}: a bag`),
      ...tables.map((path) => `${path}: a table`),
      ...(others.length > 0 ? [`not recognised: ${others.slice(0, 5).join(", ")}${others.length > 5 ? ", …" : ""}`] : []),
    ]),
  );
  part("found").hidden = files.length === 0;
  part("import").hidden = recordings.length === 0;
  part("check").hidden = part("diagnose").hidden = logs.length === 0;
  const inputs = [...recordings, found.robot, found.scene].join("\n");
  if (recordings.length > 0 && inputs !== importedFrom) {
    importedFrom = inputs;
    part("importing").replaceChildren(importing(found, files, take));
  }
  if (logs.length === 0) return;
  part("diagnosing").replaceChildren(diagnosing(found, files));
  part("checks").replaceChildren();
  for (const { folder } of logs) {
    const answer = await run(part("checking"), `Checking ${folder}`, { command: "check", logs: folder }, files);
    if (turn !== turns) return;
    if (answer) part("checks").append(check(folder, answer));
  }
}

function clear() {
  held = new Map();
  importedFrom = null;
  ["recognised", "importing", "checks", "diagnosing"].forEach((id) => part(id).replaceChildren());
  show();
}

for (const input of [part("folder"), part("files")]) {
  input.onchange = () => take(chosen(input));
  part(`choose-${input.id}`).onclick = () => input.click();
}
part("clear").onclick = clear;
part("play").onclick = () => {
  part("play").disabled = true;
  part("playground").hidden = false;
  playground(part("playing"));
};
const stage = document.body;
stage.ondragover = (event) => {
  event.preventDefault();
  part("drop").classList.add("over");
};
stage.ondragleave = () => part("drop").classList.remove("over");
stage.ondrop = async (event) => {
  event.preventDefault();
  part("drop").classList.remove("over");
  take(await dropped(event.dataTransfer));
};
