// The view of a check: contents, defects, drives, and what the logs can show.

import { folded, list, make } from "./elements.mjs";
import { room } from "./room.mjs";

const percent = (share) => `${Math.round(100 * share)} %`;
const count = (of, what) => `${of} ${what}${of === 1 ? "" : "s"}`;
const range = (of, unit) => (of ? `${Math.round(of.low)} to ${Math.round(of.high)} ${unit}` : "none");

export function check(folder, { json, text, drives, warnings }) {
  const survey = JSON.parse(json);
  const { holds } = survey;
  const facts = [
    ["Amount", `${count(holds.runs, "run")}, ${count(holds.rows, "row")}, ${(holds.duration_s / 60).toFixed(1)} min`],
    ["Rate", `a row per ${Math.round(holds.step_ms)} ms, 95 % of them within ${Math.round(holds.jitter_ms)} ms`],
    ["Coverage", `${percent(holds.with_pose)} of rows have a pose, ${percent(holds.with_reading)} a reading`],
    ["Speed", range(holds.forward_cm_s, "cm/s")],
    ["Turn rate", range(holds.turn_deg_s, "deg/s")],
    ["Readings", range(holds.reading_cm, "cm")],
  ];
  const table = make("dl", {}, ...facts.flatMap(([name, value]) => [make("dt", {}, name), make("dd", {}, value)]));
  return make(
    "article",
    { className: "card" },
    make("h3", {}, `Logs in ${folder}`),
    list(warnings, { className: "bad" }),
    make("div", { className: "pairs" }, make("div", {}, table, ...defects(survey)), room(drives)),
    ...abilities(survey),
    folded("The whole check as text", text),
  );
}

function defects({ findings, refused }) {
  if (findings.length === 0) return [make("p", { className: "good" }, "No defects found.")];
  const sentence = ({ sentence, handling }) => `${sentence} (${handling.replace("_", " ")})`;
  return [
    make("h4", {}, "Defects"),
    list(findings.map(sentence)),
    refused ? make("p", { className: "bad" }, "The logs cannot be used until this is fixed.") : "",
  ];
}

function abilities({ missing_networks, untestable, drive_more }) {
  const networks = missing_networks.map(({ network, reason }) => `No simulator of ${network} can be learned: ${reason}`);
  const effects =
    untestable.length === 0
      ? "Every known effect is testable with these logs."
      : `These effects cannot be seen in the logs, because nothing excites them: ${untestable.join(", ")}.`;
  return [make("h4", {}, "What these logs can show"), make("p", {}, effects), list([...networks, ...drive_more])];
}
