// Choices for a diagnosis, and its result.

import { made } from "./accept.mjs";
import { command, commandLines } from "./commands.mjs";
import { download, folded, list, make } from "./elements.mjs";
import { run } from "./progress.mjs";

const TEXTBOOK = "kinematic";
const SIMULATOR = "simulator.json";
const TRAIN = "train:";

/** A form that diagnoses logs among `files`. */
export function diagnosing({ logs, simulators }, files) {
  const option = (value, text) => make("option", { value }, text);
  const trainings = logs.length > 1 ? logs.map(({ folder }) => option(TRAIN + folder, `a simulator learned from ${folder}`)) : [];
  const known = simulators.map((path) => option(path, `the simulator ${path}`));
  const against = make("select", {}, ...known, option(TEXTBOOK, "a textbook robot with the measures of robot.toml"), ...trainings);
  const boxes = logs.map(({ folder }) => make("input", { type: "checkbox", value: folder, checked: true }));
  const choices = boxes.map((box) => make("label", {}, box, ` ${box.value}`));
  const button = make("button", { type: "submit", className: "main" }, "Diagnose");
  const [state, result] = [make("div", { className: "state" }), make("div")];
  const update = () => {
    boxes.forEach((box) => (box.disabled = against.value === TRAIN + box.value));
    button.disabled = chosen(boxes).length === 0;
  };
  const form = make(
    "form",
    { onchange: update },
    make("p", { className: "controls" }, make("label", {}, "Compare the logs with ", against)),
    logs.length > 1 ? make("fieldset", {}, make("legend", {}, "Sessions of one robot"), ...choices) : "",
    make("p", {}, button),
  );
  form.onsubmit = async (event) => {
    event.preventDefault();
    button.disabled = true;
    result.replaceChildren();
    result.append(...(await diagnosed(state, against.value, chosen(boxes), files)));
    result.querySelector("h3")?.focus();
    update();
  };
  return make("div", {}, form, state, result);
}

const chosen = (boxes) => boxes.filter((box) => box.checked && !box.disabled).map((box) => box.value);

/** Diagnoses, after training if that is chosen, and returns what there is to see. */
async function diagnosed(state, against, logs, files) {
  const commands = [];
  let simulator = against === TEXTBOOK ? null : against;
  const saved = [];
  if (against.startsWith(TRAIN)) {
    const folder = against.slice(TRAIN.length);
    const trained = await run(state, "Learning a simulator", { command: "train", logs: folder }, files);
    if (!trained) return [];
    const [[, text]] = trained.files;
    files = [...files, made(SIMULATOR, text)];
    simulator = SIMULATOR;
    saved.push(download(SIMULATOR, text, "application/json"));
    commands.push(command("mindgap", "train", folder, "--out", SIMULATOR));
  }
  const answer = await run(state, "Diagnosing", { command: "diagnose", simulator, logs }, files);
  if (!answer) return [];
  commands.push(diagnoseCommand(simulator ?? TEXTBOOK, ...logs));
  return shown(answer, commands, saved);
}

/** A diagnosis with its page, its files and the commands that write the same. */
export function shown({ text, json, page, warnings }, commands, saved = []) {
  const { title } = new DOMParser().parseFromString(page, "text/html");
  const verdict = make("h3", { tabIndex: -1 }, title.replace(/^Diagnosis: /, ""));
  // Its scripts run, but have no access to this page.
  const frame = make("iframe", { srcdoc: page, title: "Page of the diagnosis" });
  frame.setAttribute("sandbox", "allow-scripts");
  return [
    verdict,
    list(warnings, { className: "bad" }),
    make("p", { className: "controls" }, download("diagnosis.html", page, "text/html"), download("diagnosis.json", json, "application/json"), ...saved),
    frame,
    folded("The diagnosis as text", text),
    commandLines(commands),
  ];
}

/** The command that diagnoses these inputs. */
export function diagnoseCommand(...inputs) {
  return command("mindgap", "diagnose", ...inputs, "--json", "diagnosis.json", "--html", "diagnosis.html");
}
