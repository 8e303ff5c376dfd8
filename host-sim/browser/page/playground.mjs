// The built-in robot: drive it with a fault, and see whether the diagnosis finds the fault.

import { made } from "./accept.mjs";
import { command } from "./commands.mjs";
import { diagnoseCommand, shown } from "./diagnose.mjs";
import { make } from "./elements.mjs";
import { start } from "./jobs.mjs";
import { run } from "./progress.mjs";
import { drawn, place, robot } from "./room.mjs";

const SEED = 9;
const AMOUNT = { runs: 8, steps: 40 };
/** Enough runs of the sound robot to learn a simulator from. */
const SOUND = { command: "record", runs: 40, steps: 60, effects: [], seed: 1 };
const [LOGS, NOMINAL, SIMULATOR] = ["worn", "sound", "simulator.json"];
const FRAME_MS = 40;

/** The simulator of the sound robot, once it is learned. */
let simulator = null;

/** Shows the playground in a section. */
export async function playground(section) {
  const { json } = await start({ command: "faults" }, []).answer;
  const faults = JSON.parse(json);
  const fault = make("select", {}, ...faults.map(({ id }) => make("option", { selected: id === "drive_scale" }, id.replaceAll("_", " "))));
  const strength = make("input", { type: "range", step: "any" });
  const [value, about] = [make("output"), make("p", { className: "quiet" })];
  const [state, scene, result] = [make("div", { className: "state" }), make("div"), make("div")];
  const current = () => faults[fault.selectedIndex];
  const tell = () => (value.textContent = `${Number(strength.value).toPrecision(3)} ${current().unit}`);
  const choose = () => {
    const { about: what, is_known, lowest, highest, default: usual } = current();
    about.textContent = is_known ? what : `${what} The diagnosis knows no effect of this name.`;
    Object.assign(strength, { min: lowest, max: highest, value: usual });
    tell();
  };
  fault.onchange = choose;
  strength.oninput = tell;
  choose();
  const form = make(
    "form",
    {},
    make("p", { className: "controls" }, make("label", {}, "Fault ", fault), make("label", {}, "Strength ", strength, value)),
    about,
    make("p", {}, make("button", { type: "submit", className: "main" }, "Drive")),
  );
  form.onsubmit = async (event) => {
    event.preventDefault();
    result.replaceChildren();
    scene.replaceChildren();
    const effects = [`${current().id}=${strength.value}`];
    const driven = await run(state, "Driving", { command: "record", ...AMOUNT, effects, seed: SEED }, []);
    if (!driven) return;
    const diagnose = make("button", { type: "button", className: "main" }, "Diagnose these drives");
    scene.replaceChildren(film(driven.sound_drives, driven.drives), make("p", {}, diagnose));
    diagnose.onclick = async () => {
      diagnose.disabled = true;
      result.replaceChildren(...(await found(state, driven.files, effects)));
      diagnose.disabled = false;
    };
  };
  section.append(form, state, scene, result);
}

/** Diagnoses the drives against a simulator of the sound robot. */
async function found(state, drives, effects) {
  simulator ??= await learned(state);
  if (!simulator) return [];
  const files = [...in_folder(LOGS, drives), made(SIMULATOR, simulator)];
  const answer = await run(state, "Diagnosing", { command: "diagnose", simulator: SIMULATOR, logs: [LOGS] }, files);
  const recorded = (out, { runs, steps, seed }) => ["mindgap", "record", "--out", out, "--runs", runs, "--steps", steps, "--seed", seed];
  const commands = [
    command(...recorded(NOMINAL, SOUND)),
    command("mindgap", "train", NOMINAL, "--out", SIMULATOR),
    command(...recorded(LOGS, { ...AMOUNT, seed: SEED }), "--effect", effects[0]),
    diagnoseCommand(SIMULATOR, LOGS),
  ];
  return answer ? shown(answer, commands) : [];
}

async function learned(state) {
  const sound = await run(state, "Driving the robot without a fault", SOUND, []);
  const request = { command: "train", logs: NOMINAL };
  const trained = sound && (await run(state, "Learning a simulator of it", request, in_folder(NOMINAL, sound.files)));
  return trained ? trained.files[0][1] : null;
}

const in_folder = (folder, files) => files.map(([name, text]) => made(`${folder}/${name}`, text));

/** The same run of both robots, to play and to move through. */
function film(sound, faulty) {
  const runs = sound.runs.map(({ name }) => make("option", {}, name));
  const [run, moment] = [make("select", {}, ...runs), make("input", { type: "range", min: 0, value: 0, ariaLabel: "Moment of the run" })];
  const play = make("button", { type: "button" }, "Play");
  const view = make("div");
  let [bodies, drives, timer] = [[], [], null];
  const move = () => drives.forEach(({ poses }, i) => poses[moment.value] && place(bodies[i], poses[moment.value]));
  const pause = () => {
    clearInterval(timer);
    timer = null;
    play.textContent = "Play";
  };
  const show = () => {
    pause();
    drives = [sound, faulty].map(({ runs }) => runs[run.selectedIndex]);
    const [drawing] = drawn({ walls_cm: sound.walls_cm, runs: [drives[0]] }, "simulator");
    const [other] = drawn({ walls_cm: [], runs: [drives[1]] }, "effects");
    bodies = ["simulator", "effects"].map(robot);
    drawing.append(...other.children, ...bodies);
    drawing.setAttribute("role", "img");
    drawing.setAttribute("aria-label", "The room from above, with the paths of the robot with and without the fault");
    view.replaceChildren(drawing);
    Object.assign(moment, { max: Math.min(...drives.map(({ poses }) => poses.length)) - 1, value: 0 });
    move();
  };
  play.onclick = () => {
    if (timer !== null) return pause();
    if (Number(moment.value) >= Number(moment.max)) moment.value = 0;
    play.textContent = "Pause";
    timer = setInterval(() => {
      moment.value = Number(moment.value) + 1;
      move();
      if (Number(moment.value) >= Number(moment.max)) pause();
    }, FRAME_MS * 3);
  };
  run.onchange = show;
  moment.oninput = move;
  show();
  const caption = make("figcaption", {}, "Both robots get the same commands. Blue: without the fault. Orange: with it.");
  return make("figure", {}, view, caption, make("p", { className: "controls" }, make("label", {}, "Run ", run), play, moment));
}
