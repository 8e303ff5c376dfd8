// The command lines that do the same as the page.

import { make } from "./elements.mjs";

/** A command as a shell takes it. */
export function command(...words) {
  return words.map(String).map((word) => (/^[\w./=-]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`)).join(" ");
}

/** Commands with a remark. */
export function commandLines(commands) {
  const lines = make("pre", { tabIndex: 0, role: "region", ariaLabel: "Command lines" }, commands.join("\n"));
  return make("div", {}, make("p", {}, "The command line gives the same bytes:"), lines);
}
