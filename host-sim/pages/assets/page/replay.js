"use strict";
// Replay: robots on a map of the room at one moment, and how their readings and distances went over the run. The page has
// the room and the axes; this draws what moves, in units of the data with y downwards: cm on the map, seconds and cm over time.

const { runs, kinds, robot } = JSON.parse(document.getElementById("data").textContent);
const element = (id) => document.getElementById(id);
const [choice, slider, button, clock] = ["run", "moment", "play", "clock"].map(element);

/** A new SVG element in another. */
function shape(parent, tag, attributes = {}) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  parent.append(made);
  return made;
}

const show = (shown, ...shapes) =>
  shapes.forEach((one) => (shown ? one.removeAttribute("display") : one.setAttribute("display", "none")));

/** A path through places, broken where one is null. */
function through(places) {
  let pen = "M";
  return places
    .map((place) => {
      const step = place && `${pen}${place[0]},${-place[1]}`;
      pen = place ? "L" : "M";
      return step ?? "";
    })
    .join("");
}

/** A number as people write it: three digits, a true minus. */
function said(value) {
  if (value === null) return "–";
  const digits = Math.abs(value) >= 100 ? 0 : Math.abs(value) >= 10 ? 1 : 2;
  return value.toFixed(digits).replace("-", "−");
}

const apart = (a, b) => (a && b ? Math.hypot(a[0] - b[0], a[1] - b[1]) : null);
const pose = (track, row) => ((track.x[row] ?? null) === null ? null : [track.x[row], track.y[row], track.heading[row]]);

/** The pose on a track at a row, or a share of the way to the next. */
function between(track, row, share) {
  const [now, next] = [pose(track, row), share > 0 ? pose(track, row + 1) : null];
  if (!now || !next) return now;
  const turn = ((next[2] - now[2] + 540) % 360) - 180;
  return [now[0] + share * (next[0] - now[0]), now[1] + share * (next[1] - now[1]), now[2] + share * turn];
}

/** A robot on the map: its whole trail faint, its trail so far, its beam and itself. */
function actor({ id }) {
  const group = shape(element("stage"), "g", { class: id });
  const whole = shape(group, "path", { class: "trail whole" }),
    past = shape(group, "path", { class: "trail" }),
    beam = shape(group, "line", { class: "beam" }),
    echo = shape(group, "circle", { class: "echo", r: robot.radius_cm / 4 }),
    body = shape(group, "g");
  shape(body, "circle", { class: "body", r: robot.radius_cm });
  shape(body, "line", { class: "nose", x2: robot.radius_cm });
  let track, places;
  return {
    id,
    group,
    follow(run) {
      track = run.tracks[id];
      places = track.x.map((_, row) => pose(track, row));
      whole.setAttribute("d", through(places));
    },
    go(row, share) {
      const at = between(track, row, share),
        reading = track.echo[row];
      const heard = at && reading !== null;
      show(at, body);
      show(heard, beam, echo);
      past.setAttribute("d", through([...places.slice(0, row + 1), ...(at ? [at] : [])]));
      if (!at) return;
      body.setAttribute("transform", `translate(${at[0]} ${-at[1]}) rotate(${-at[2]})`);
      if (!heard) return;
      const heading = (at[2] * Math.PI) / 180,
        [ahead, left, yaw_deg] = robot.sensor,
        axis = heading + (yaw_deg * Math.PI) / 180,
        [cos, sin] = [Math.cos(heading), Math.sin(heading)];
      const from = [at[0] + ahead * cos - left * sin, at[1] + ahead * sin + left * cos];
      const to = [from[0] + reading * Math.cos(axis), from[1] + reading * Math.sin(axis)];
      Object.entries({ x1: from[0], y1: -from[1], x2: to[0], y2: -to[1] }).forEach(([name, cm]) => beam.setAttribute(name, cm));
      echo.setAttribute("cx", to[0]);
      echo.setAttribute("cy", -to[1]);
    },
  };
}

/** A chart over the time of a run: a line and dots per robot, and a cursor at the moment; nothing where there is no chart. */
function overTime(name, valueOf) {
  const plane = document.querySelector(`[data-chart=${name}] .plane`);
  if (!plane) return { follow() {}, go() {}, shown() {} };
  const lines = kinds.map(({ id }) => {
    const group = shape(plane, "g", { class: id });
    return { id, group, line: shape(group, "path", { class: "trail" }), dots: shape(group, "path", { class: "dots" }) };
  });
  const cursor = shape(plane, "line", { class: "cursor", y1: -1e6, y2: 0 });
  return {
    follow(run) {
      for (const { id, line, dots } of lines) {
        const places = run.t_s.map((t, row) => {
          const value = valueOf(run, id, row);
          return value === null ? null : [t, value];
        });
        line.setAttribute("d", through(places));
        // A stroke of no length with round ends is a dot, whatever the scales are.
        dots.setAttribute("d", places.map((place) => (place ? `M${place[0]},${-place[1]}h0` : "")).join(""));
      }
    },
    go: (t_s) => ["x1", "x2"].forEach((end) => cursor.setAttribute(end, t_s)),
    shown: (id, is) => show(is, lines.find((one) => one.id === id).group),
  };
}

const actors = kinds.map(actor);
const first = kinds[0].id;
const charts = [
  overTime("readings", (run, id, row) => run.tracks[id].echo[row]),
  overTime("apart", (run, id, row) => (id === first ? null : apart(pose(run.tracks[id], row), pose(run.tracks[first], row)))),
];
const state = { run: runs[0], at: 0, playing: false };

function choose(number) {
  state.run = runs[number];
  slider.max = state.run.t_s.length - 1;
  [...actors, ...charts].forEach((one) => one.follow(state.run));
  go(0);
}

/** Shows a moment: a row of the run, or a share of the way to the next. */
function go(at) {
  const { t_s, tracks, remarks } = state.run;
  state.at = Math.max(0, Math.min(at, t_s.length - 1));
  const row = Math.floor(state.at),
    share = state.at - row;
  const now_s = t_s[row] + (share > 0 ? share * (t_s[row + 1] - t_s[row]) : 0);
  slider.value = row;
  slider.setAttribute("aria-valuetext", `${now_s.toFixed(1)} s`);
  clock.textContent = `${now_s.toFixed(1)} s of ${t_s.at(-1).toFixed(1)} s · ${remarks[row]}`;
  actors.forEach((one) => one.go(row, share));
  charts.forEach((one) => one.go(now_s));
  kinds.forEach(({ id }) => tabulate(id, pose(tracks[id], row), tracks[id].echo[row], pose(tracks[first], row)));
}

function tabulate(id, at, reading, real) {
  const cell = (field, text) => {
    document.querySelector(`[data-kind="${id}"] [data-field="${field}"]`).textContent = text;
  };
  cell("place", at ? `${said(at[0])}, ${said(at[1])}` : "not seen");
  cell("heading", at ? `${Math.round(at[2])}°`.replace("-", "−") : "–");
  cell("echo", reading === null ? "none" : said(reading));
  if (kinds.length > 1) cell("off", id === first ? "" : said(apart(at, real)));
}

function play(last) {
  if (!state.playing) return;
  requestAnimationFrame((now) => {
    const { t_s } = state.run,
      row = Math.floor(state.at);
    const step_s = Math.max((t_s[row + 1] ?? t_s[row]) - t_s[row], 0.001);
    // At twice the speed of the robot, but no more than one row per frame: every row is seen.
    go(Math.min(state.at + (2 * (now - (last ?? now))) / 1000 / step_s, row + 1));
    if (state.at >= t_s.length - 1) pause();
    else play(now);
  });
}

function pause() {
  state.playing = false;
  button.textContent = "Play";
}

choice.addEventListener("change", () => {
  pause();
  choose(Number(choice.value));
});
slider.addEventListener("input", () => {
  pause();
  go(Number(slider.value));
});
button.addEventListener("click", () => {
  if (state.playing) return pause();
  if (state.at >= state.run.t_s.length - 1) go(0);
  state.playing = true;
  button.textContent = "Pause";
  play();
});
document.querySelectorAll("[data-show]").forEach((box) =>
  box.addEventListener("change", () => {
    const id = box.dataset.show;
    show(box.checked, actors.find((one) => one.id === id).group);
    charts.forEach((one) => one.shown(id, box.checked));
  }),
);
choose(0);
