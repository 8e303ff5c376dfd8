"use strict";
// A table that is sorted by the column whose name is clicked.

/** Sorts a table by a column; numbers are in the cells' data-value. */
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

document.querySelectorAll("th button").forEach((button) => button.addEventListener("click", () => sortBy(button)));
