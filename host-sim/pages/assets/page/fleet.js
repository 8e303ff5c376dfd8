"use strict";
// The charts of a fleet, and its table, which sorts by the column that is clicked.

charts.frequencies = (width) =>
  namedShares(page.frequencies, width, "robots that have it (%) →", [
    Plot.ruleY(page.frequencies, {
      x1: (f) => 100 * f.ci95[0],
      x2: (f) => 100 * f.ci95[1],
      y: (_, i) => i,
      stroke: "var(--effects)",
      strokeWidth: 4,
      strokeOpacity: 0.5,
    }),
    Plot.dot(page.frequencies, {
      x: (f) => 100 * f.share,
      y: (_, i) => i,
      r: 6,
      fill: "var(--paper)",
      stroke: "var(--effects)",
      strokeWidth: 2.5,
    }),
  ]);

charts.groups = (width) =>
  Plot.plot({
    width,
    height: 46 * page.groups.length + 90,
    marginLeft: 70,
    marginRight: 16,
    marginTop: 6,
    marginBottom: 40,
    color: { legend: true, scheme: "observable10", domain: [...new Set(page.shares.map((s) => s.name))] },
    x: { domain: [0, 100], grid: true, label: "mean share of the gap (%) →", labelAnchor: "right" },
    y: { domain: page.groups, label: null, padding: 0.3 },
    marks: [
      Plot.barX(page.shares, {
        x: (s) => 100 * s.share,
        y: "group",
        fill: "name",
        inset: 0.5,
        title: (s) => `${s.name} ${percent(s.share)}`,
      }),
    ],
  });

/** Sorts a table by a column; numbers come in cells' data-value. */
function sortBy(button) {
  const head = button.closest("th"),
    table = head.closest("table"),
    column = [...head.parentElement.children].indexOf(head);
  const descending = head.getAttribute("aria-sort") === "ascending";
  const value = (row) => row.children[column].dataset.value ?? row.children[column].textContent;
  const order = new Intl.Collator("en", { numeric: true }).compare;
  const rows = [...table.tBodies[0].rows].sort((a, b) => (descending ? -1 : 1) * order(value(a), value(b)));
  table.tBodies[0].append(...rows);
  for (const other of head.parentElement.children) other.removeAttribute("aria-sort");
  head.setAttribute("aria-sort", descending ? "descending" : "ascending");
}

addEventListener("DOMContentLoaded", () => {
  document.querySelectorAll("th button").forEach((button) => button.addEventListener("click", () => sortBy(button)));
});
