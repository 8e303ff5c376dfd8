"use strict";
// Replay: robots on a map of the room at one moment, their beams and readings, and how readings went. The map is drawn
// here, in cm with y upwards; time charts are drawn by the library.

addEventListener("DOMContentLoaded", () => {
  const { runs, kinds, robot } = page.replay;
  const element = (id) => document.getElementById(id);
  const [choice, slider, button, clock] = ["run", "moment", "play", "clock"].map(element);
  const stage = d3.select("#stage");
  const state = { run: runs[0], at: 0, playing: false, shown: new Set(kinds.map((kind) => kind.id)) };

  drawRoom(stage, page.room);
  const actors = kinds.map((kind) => actor(stage, kind, robot));

  function choose(number) {
    state.run = runs[number];
    slider.max = state.run.t_s.length - 1;
    actors.forEach((a) => a.follow(state.run.tracks[a.id]));
    drawCharts();
    go(0);
  }

  /** Shows a moment: a row of the run, or a share of the way to the next. */
  function go(at) {
    const { run } = state;
    state.at = Math.max(0, Math.min(at, run.t_s.length - 1));
    const row = Math.floor(state.at),
      share = state.at - row;
    const t_s = run.t_s[row] + (share > 0 ? share * (run.t_s[row + 1] - run.t_s[row]) : 0);
    slider.value = row;
    slider.setAttribute("aria-valuetext", `${t_s.toFixed(1)} s`);
    clock.textContent = `${t_s.toFixed(1)} s of ${run.t_s.at(-1).toFixed(1)} s · ${run.told[row]}`;
    const here = moment(run.tracks[kinds[0].id], row, 0);
    for (const a of actors) {
      const now = moment(run.tracks[a.id], row, share);
      a.show(now, row);
      tell(a.id, moment(run.tracks[a.id], row, 0), here);
    }
    d3.selectAll(".cursor").each(function () {
      this.move(t_s);
    });
  }

  function tell(id, now, here) {
    const cell = (field, text) => {
      document.querySelector(`[data-kind="${id}"] [data-field="${field}"]`).textContent = text;
    };
    cell("place", now.pose ? `${said(now.pose[0])}, ${said(now.pose[1])}` : "not seen");
    cell("heading", now.pose ? `${Math.round(now.pose[2])}°`.replace("-", "−") : "–");
    cell("echo", now.echo === null ? "none" : said(now.echo));
    const off = now.pose && here.pose ? Math.hypot(now.pose[0] - here.pose[0], now.pose[1] - here.pose[1]) : null;
    if (kinds.length > 1) cell("off", id === kinds[0].id ? "" : said(off));
  }

  function play(last) {
    if (!state.playing) return;
    requestAnimationFrame((now) => {
      const { t_s } = state.run,
        row = Math.floor(state.at);
      const step_s = Math.max((t_s[row + 1] ?? t_s[row]) - t_s[row], 0.001);
      const at = state.at + (2 * (now - (last ?? now))) / 1000 / step_s;
      // No more than one row a frame: what is skipped was not seen.
      go(Math.min(at, row + 1));
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
      state.shown[box.checked ? "add" : "delete"](box.dataset.show);
      actors.forEach((a) => a.group.attr("display", state.shown.has(a.id) ? null : "none"));
      drawCharts();
      go(state.at);
    }),
  );

  function drawCharts() {
    for (const place of document.querySelectorAll('[data-chart="readings"], [data-chart="apart"]')) {
      delete place.dataset.drawn;
      draw(place);
    }
  }

  const points = (of) =>
    kinds
      .filter((kind) => state.shown.has(kind.id))
      .flatMap((kind) => {
        const track = state.run.tracks[kind.id],
          first = state.run.tracks[kinds[0].id];
        return state.run.t_s.map((t, i) => ({ t, kind: kind.id, value: of(track, first, i) }));
      });

  /** A chart over the time of the run, with a line at the moment that is shown. */
  function overTime(width, height, label, values) {
    const dashes = { simulator: "7 4", effects: "2 4" };
    const of = (kind) => values.filter((v) => v.kind === kind.id);
    const chart = Plot.plot({
      width,
      height,
      marginLeft: 46,
      marginTop: 30,
      marginBottom: 40,
      x: { domain: [0, state.run.t_s.at(-1)], label: "time (s) →" },
      y: { label, grid: true, zero: true, nice: true, ticks: 4 },
      marks: kinds.flatMap((kind) => [
        Plot.line(of(kind), {
          x: "t",
          y: "value",
          stroke: `var(--${kind.id})`,
          strokeWidth: 1.8,
          strokeDasharray: dashes[kind.id],
        }),
        Plot.dot(of(kind), { x: "t", y: "value", fill: `var(--${kind.id})`, r: 1.6, filter: (v) => v.value !== null }),
      ]),
    });
    const x = chart.scale("x");
    const cursor = d3
      .select(chart)
      .append("line")
      .attr("class", "cursor")
      .attr("y1", 26)
      .attr("y2", height - 38)
      .node();
    cursor.move = (t_s) => {
      cursor.setAttribute("x1", x.apply(t_s));
      cursor.setAttribute("x2", x.apply(t_s));
    };
    cursor.move(state.run.t_s[Math.floor(state.at)]);
    return chart;
  }
  charts.readings = (width) =>
    overTime(
      width,
      210,
      "↑ reading (cm)",
      points((track, _, i) => track.echo[i]),
    );
  charts.apart = (width) =>
    overTime(
      width,
      180,
      "↑ away from the robot (cm)",
      points((track, first, i) =>
        track === first || track.x[i] === null || first.x[i] === null
          ? null
          : Math.hypot(track.x[i] - first.x[i], track.y[i] - first.y[i]),
      ),
    );

  choose(0);
});

/** Where a track is at a row, or a share of the way to the next. */
function moment(track, row, share) {
  const pose = (i) =>
    track.x[i] === null || track.x[i] === undefined ? null : [track.x[i], track.y[i], track.heading[i]];
  const [now, next] = [pose(row), share > 0 ? pose(row + 1) : null];
  const echo = track.echo[row];
  if (!now || !next) return { pose: now, echo };
  const turn = ((next[2] - now[2] + 540) % 360) - 180;
  return {
    pose: [now[0] + share * (next[0] - now[0]), now[1] + share * (next[1] - now[1]), now[2] + share * turn],
    echo,
  };
}

function drawRoom(stage, { bounds, walls, obstacles, target }) {
  const [x0, y0, x1, y1] = bounds,
    edge = 0.03 * Math.max(x1 - x0, y1 - y0);
  stage.attr("viewBox", [x0 - edge, -y1 - edge, x1 - x0 + 2 * edge, y1 - y0 + 2 * edge].join(" "));
  obstacles.forEach((o) =>
    stage
      .append("rect")
      .attr("class", "obstacle")
      .attr("x", o[0])
      .attr("y", -o[3])
      .attr("width", o[2] - o[0])
      .attr("height", o[3] - o[1]),
  );
  walls.forEach((w) =>
    stage.append("line").attr("class", "wall").attr("x1", w[0]).attr("y1", -w[1]).attr("x2", w[2]).attr("y2", -w[3]),
  );
  if (target)
    stage.append("circle").attr("class", "target").attr("cx", target[0]).attr("cy", -target[1]).attr("r", target[2]);
}

/** A robot on the stage: its whole trail faint, its trail so far, its beam and itself. */
function actor(stage, kind, { radius_cm, sensor }) {
  const group = stage.append("g").attr("class", kind.id);
  const [whole, past] = ["trail whole", "trail"].map((name) => group.append("path").attr("class", name));
  const beam = group.append("line").attr("class", "beam");
  const echo = group
    .append("circle")
    .attr("class", "echo")
    .attr("r", radius_cm / 4);
  const body = group.append("g");
  body.append("circle").attr("class", "body").attr("r", radius_cm);
  body.append("line").attr("class", "nose").attr("x2", radius_cm);
  const line = d3
    .line()
    .defined((p) => p !== null)
    .x((p) => p[0])
    .y((p) => -p[1]);
  let places = [];
  return {
    id: kind.id,
    group,
    follow(track) {
      places = track.x.map((x, i) => (x === null ? null : [x, track.y[i]]));
      whole.attr("d", line(places));
    },
    show({ pose, echo: reading }, row) {
      body.attr("display", pose ? null : "none");
      const heard = pose && reading !== null;
      [beam, echo].forEach((mark) => mark.attr("display", heard ? null : "none"));
      past.attr("d", line(pose ? [...places.slice(0, row + 1), [pose[0], pose[1]]] : places.slice(0, row + 1)));
      if (!pose) return;
      const heading = (pose[2] * Math.PI) / 180,
        [cos, sin] = [Math.cos(heading), Math.sin(heading)];
      body.attr("transform", `translate(${pose[0]} ${-pose[1]}) rotate(${-pose[2]})`);
      if (!heard) return;
      const [ahead, left, yaw_deg] = sensor,
        axis = heading + (yaw_deg * Math.PI) / 180;
      const from = [pose[0] + ahead * cos - left * sin, pose[1] + ahead * sin + left * cos];
      const to = [from[0] + reading * Math.cos(axis), from[1] + reading * Math.sin(axis)];
      beam.attr("x1", from[0]).attr("y1", -from[1]).attr("x2", to[0]).attr("y2", -to[1]);
      echo.attr("cx", to[0]).attr("cy", -to[1]);
    },
  };
}
