// assemble.mjs MODULE PAGE: puts the parts of the page and the module into one HTML file.

import { readFileSync, writeFileSync } from "node:fs";
import { gzipSync } from "node:zlib";

const SCRIPTS = ["elements", "jobs", "accept", "recognise", "commands", "progress", "zip", "room", "check", "diagnose", "import", "playground", "main"];

const [module, page] = process.argv.slice(2);
const read = (path) => readFileSync(new URL(path, import.meta.url), "utf8");
/** A script as a function of its own, since a page from disk can load no modules. */
const enclosed = (name) => {
  const text = read(`page/${name}.mjs`);
  const exported = [...text.matchAll(/^export (?:async )?(?:function|class) (\w+)/gm)].map(([, name]) => name);
  const body = text
    .replace(/^import (\{.*\}) from "\.\/(\w+)\.mjs";$/gm, "const $1 = $2_part;")
    .replace(/^export /gm, "");
  return `const ${name}_part = (() => {\n${body}return { ${exported.join(", ")} };\n})();\n`;
};
/** Scripts as one, in the order of their dependencies. */
const joined = (names) => names.map(enclosed).join("");

const parts = {
  style: read("../pages/assets/page/style.css") + read("page/style.css"),
  measures: read("page/measures.svg"),
  worker: joined(["host", "worker"]),
  module: gzipSync(readFileSync(module), { level: 9 }).toString("base64"),
  script: joined(SCRIPTS),
};
writeFileSync(page, read("page/index.html").replace(/\{\{(\w+)\}\}/g, (_, name) => parts[name]));
