// The drives of a robot in its room, as a drawing.

import { make, shape } from "./elements.mjs";

const MARGIN_CM = 8;
const ROBOT_CM = 10;

/** A drawing of all drives; a choice shows a single one. */
export function room(drives) {
  const names = drives.runs.map(({ name }) => name);
  const [drawing, paths] = drawn(drives);
  drawing.setAttribute("role", "img");
  drawing.setAttribute("aria-label", `The room from above, with the paths of ${names.length} runs`);
  const choice = make("select", {}, make("option", { value: "" }, "all runs"), ...names.map((name) => make("option", {}, name)));
  choice.onchange = () => paths.forEach((path, run) => path.toggleAttribute("hidden", choice.value !== "" && choice.value !== names[run]));
  const controls = make("p", { className: "controls" }, make("label", {}, "Show ", choice));
  const caption = make("figcaption", {}, "The room from above. A dot marks the start of each run.");
  return make("figure", {}, drawing, caption, names.length > 1 ? controls : "");
}

/** The drawing of drives, and the group of each run in it. Lengths are cm, and y points up. */
export function drawn({ walls_cm, runs }, className = "robot") {
  const ends = walls_cm.flatMap(([x0, y0, x1, y1]) => [[x0, y0], [x1, y1]]);
  const points = [...ends, ...runs.flatMap(({ poses }) => poses.filter(Boolean))];
  const [left, right] = range(points.map(([x]) => x));
  const [bottom, top] = range(points.map(([, y]) => y));
  const view = [left, -top, right - left, top - bottom].join(" ");
  const walls = walls_cm.map(([x1, y1, x2, y2]) => shape("line", { x1, y1: -y1, x2, y2: -y2, class: "wall" }));
  const paths = runs.map((run) => path(run, className));
  return [shape("svg", { viewBox: view, class: "room" }, ...walls, ...paths), paths];
}

/** The robot at a pose. */
export function robot(className) {
  const body = shape("circle", { r: ROBOT_CM });
  return shape("g", { class: `body ${className}` }, body, shape("line", { x1: 0, y1: 0, x2: ROBOT_CM, y2: 0 }));
}

/** Moves a robot to a pose. */
export function place(body, [x, y, heading_rad]) {
  body.setAttribute("transform", `translate(${x} ${-y}) rotate(${(-180 * heading_rad) / Math.PI})`);
}

function path({ poses }, className) {
  // The line is interrupted where the tracker lost the robot.
  const step = (pose, i) => (pose ? `${poses[i - 1] ? "L" : "M"}${pose[0].toFixed(1)} ${(-pose[1]).toFixed(1)}` : "");
  const line = shape("path", { d: poses.map(step).join(""), class: className });
  const first = poses.find(Boolean);
  const start = first ? shape("path", { d: `M${first[0]} ${-first[1]}h0`, class: `start ${className}` }) : "";
  return shape("g", {}, line, start);
}

/** The range of numbers with a margin; spread arguments would not do for long logs. */
function range(numbers) {
  const [low, high] = numbers.reduce(([low, high], of) => [Math.min(low, of), Math.max(high, of)], [Infinity, -Infinity]);
  return low <= high ? [low - MARGIN_CM, high + MARGIN_CM] : [-100, 100];
}
