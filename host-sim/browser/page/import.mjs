// Imports recordings as logs, and asks for the measures of the robot that they do not hold.

import { made } from "./accept.mjs";
import { command, commandLines } from "./commands.mjs";
import { download, list, make } from "./elements.mjs";
import { run } from "./progress.mjs";

/** Folder of imported logs. */
const LOGS = "logs";
/** File of the measures. */
const ROBOT = "robot.toml";
const UNIT = /_(cm_s|cm|ms|deg)$/;
const MEASURE = /^robot\.toml: (\w+) = (\S+) \((.*)\)$/;

/** A form that imports recordings, and hands the files of the logs to `take`. */
export function importing({ bags, tables, robot, scene }, files, take) {
  const [state, result] = [make("div", { className: "state" }), make("div")];
  const button = make("button", { type: "button", className: "main" }, "Import as logs");
  const work = async (robot, files, saved = "") => {
    const are_bags = bags.length > 0;
    const recordings = are_bags ? bags : tables;
    const answer = await run(state, "Importing", { command: "import", are_bags, recordings, robot, scene }, files);
    if (!answer) return;
    take(answer.files.map(([name, text]) => made(`${LOGS}/${name}`, text)));
    const given = Object.entries({ "--robot": robot, "--scene": scene }).filter(([, path]) => path).flat();
    const line = command("mindgap", "import", are_bags ? "bag" : "streams", ...recordings, ...given, "--out", LOGS);
    const again = (text) => work(ROBOT, [...files, made(ROBOT, text)], download(ROBOT, text, "text/plain"));
    result.replaceChildren(...report(answer, again), saved, commandLines([line]));
  };
  button.onclick = () => work(robot, files);
  return make("div", {}, make("p", {}, button), state, result);
}

function report({ json, files, warnings }, again) {
  const { recordings, left_out, findings, to_fill_in } = JSON.parse(json);
  const sources = recordings.flatMap(({ sources }) => sources);
  const read = sources.map(({ name, samples, rate_hz }) => `${name}: ${samples} samples at ${rate_hz.toFixed(1)} Hz`);
  const guesses = sources.flatMap(({ guessed }) => guessed);
  const unused = left_out.map(({ name, reason }) => `${name}: ${reason}`);
  return [
    list(read),
    list([...warnings, ...guesses, ...unused, ...findings], { className: "quiet" }),
    measures(to_fill_in, Object.fromEntries(files)[ROBOT], again),
  ];
}

/** A form for the measures that are still to be filled in; `again` takes the completed text of robot.toml. */
function measures(open, text, again) {
  const asked = open.map((line) => line.match(MEASURE)).filter(Boolean);
  if (asked.length === 0) return "";
  const inputs = asked.map(([, name, value]) => make("input", { type: "number", step: "any", required: true, name, value }));
  const labels = asked.map(([, name, , what], i) =>
    make("label", {}, make("strong", {}, words(name)), ` (${what}) `, inputs[i], ` ${unit(name)}`),
  );
  const form = make(
    "form",
    { className: "card measures" },
    make("h3", {}, "Measure the robot"),
    make("p", {}, "The recordings do not hold these. Measure them with a ruler: an error in one looks like a fault of the robot."),
    document.getElementById("measures-picture").content.cloneNode(true),
    ...labels.map((label) => make("p", {}, label)),
    make("p", {}, make("button", { type: "submit", className: "main" }, "Use these measures")),
  );
  form.onsubmit = (event) => {
    event.preventDefault();
    again(inputs.reduce((text, { name, value }) => text.replace(new RegExp(`^${name} = .*$`, "m"), `${name} = ${value}`), text));
  };
  return form;
}

/** The name of a measure in words; short names are of the table of the range sensor. */
const words = (name) => (/^(x|y|min|max)_/.test(name) ? "sensor " : "") + name.replace(UNIT, "").replaceAll("_", " ");
const unit = (name) => name.match(UNIT)?.[1].replace("cm_s", "cm/s") ?? "";
