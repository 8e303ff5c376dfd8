"use strict";
// What all pages share: the data, the colours, and charts that are drawn anew when the room for them changes.

const page = JSON.parse(document.getElementById("data").textContent);

/** Charts by name: each is given its width in px and its number among those of its name, and returns an element. */
const charts = {};

const KINDS = ["without", "with", "scatter alone"];
const kindScale = (domain, range) => ({
  color: { domain, range },
  symbol: { domain, range: ["circle", "diamond", "cross"].slice(0, domain.length), legend: true },
});
const BEFORE_AFTER = ["var(--simulator)", "var(--effects)", "var(--third)"];

/** A number as one says it: three digits, a true minus. */
function said(value) {
  if (value === null || value === undefined) return "–";
  const digits = Math.abs(value) >= 100 ? 0 : Math.abs(value) >= 10 ? 1 : 2;
  return value.toFixed(digits).replace("-", "−");
}

const percent = (share) => `${Math.round(100 * share)} %`;

/** A map of the room: size, axes and scales for a width. */
function mapOf(room, width) {
  const [x0, y0, x1, y1] = room.bounds;
  // The inset keeps half of a wall at the edge from being cut off.
  const margins = { marginLeft: 46, marginRight: 20, marginTop: 30, marginBottom: 40, inset: 2 };
  // One length for a centimetre along both axes.
  const scale = Math.min((width - 70) / (x1 - x0), 520 / (y1 - y0));
  const ticks = (cm) => Math.max(2, Math.round((cm * scale) / 60));
  return {
    ...margins,
    width: (x1 - x0) * scale + 70,
    height: (y1 - y0) * scale + 74,
    x: { domain: [x0, x1], label: "x (cm) →", ticks: ticks(x1 - x0) },
    y: { domain: [y0, y1], label: "↑ y (cm)", ticks: ticks(y1 - y0) },
  };
}

/** The walls and obstacles of the room as marks. */
function roomMarks(room) {
  return [
    Plot.rect(room.obstacles, {
      x1: (o) => o[0],
      y1: (o) => o[1],
      x2: (o) => o[2],
      y2: (o) => o[3],
      fill: "var(--solid)",
      fillOpacity: 0.6,
      stroke: "var(--quiet)",
      clip: true,
    }),
    Plot.link(room.walls, {
      x1: (w) => w[0],
      y1: (w) => w[1],
      x2: (w) => w[2],
      y2: (w) => w[3],
      stroke: "currentColor",
      strokeWidth: 1.5,
      clip: true,
    }),
  ];
}

/** The target of the room, where it has one: the ring within which a run has reached it. */
function targetMark({ target }) {
  if (!target) return null;
  const [x, y, radius] = target;
  const radians = (degrees) => (degrees * Math.PI) / 180;
  return Plot.line(d3.range(0, 361, 6), {
    x: (a) => x + radius * Math.cos(radians(a)),
    y: (a) => y + radius * Math.sin(radians(a)),
    stroke: "var(--third)",
    strokeWidth: 2,
  });
}

/** Shares in percent, one a row below its name; `marks` draw them, at the number of the row. */
function namedShares(rows, width, label, marks) {
  return Plot.plot({
    width,
    height: 50 * rows.length + 50,
    marginLeft: 8,
    marginRight: 16,
    marginTop: 6,
    marginBottom: 40,
    x: { domain: [0, 100], grid: true, label, labelAnchor: "right" },
    y: { type: "band", domain: rows.map((_, i) => i), axis: null, padding: 0.55, paddingOuter: 0.35 },
    marks: [
      ...marks,
      Plot.text(rows, {
        x: 0,
        y: (_, i) => i,
        dy: -20,
        textAnchor: "start",
        fontSize: 13,
        lineWidth: width / 13 - 4,
        textOverflow: "ellipsis",
        text: (row) => `${percent(row.share)}  ${row.name}`,
        title: (row) => row.name,
      }),
    ],
  });
}

function draw(place) {
  const width = Math.floor(place.clientWidth);
  if (width === 0 || Number(place.dataset.drawn) === width) return;
  place.dataset.drawn = width;
  const chart = charts[place.dataset.chart](Math.min(width, 860), Number(place.dataset.number ?? 0));
  // The alternative in words belongs to the place; what is inside is for the eye alone.
  chart.setAttribute("aria-hidden", "true");
  place.replaceChildren(chart);
}

// In the next frame: what is drawn changes heights, of which the observer must not hear in the same.
const watcher = new ResizeObserver((entries) =>
  requestAnimationFrame(() => entries.forEach((entry) => draw(entry.target))),
);
addEventListener("DOMContentLoaded", () => {
  document.querySelectorAll("[data-chart]").forEach((place) => watcher.observe(place));
});
