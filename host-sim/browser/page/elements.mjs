// Makes elements.

/** An element with attributes, listeners (`onclick`) and children, which are elements or text. */
export function make(name, attributes = {}, ...children) {
  return fill(document.createElement(name), attributes, ...children);
}

/** The same in a drawing. */
export function shape(name, attributes = {}, ...children) {
  return fill(document.createElementNS("http://www.w3.org/2000/svg", name), attributes, ...children);
}

/** A list of texts, or nothing if there are none. */
export function list(texts, attributes = {}) {
  return texts.length > 0 ? make("ul", attributes, ...texts.map((text) => make("li", {}, text))) : "";
}

/** Text that opens on a click. */
export function folded(summary, text) {
  const region = { className: "wide", tabIndex: 0, role: "region", ariaLabel: summary };
  return make("details", {}, make("summary", {}, summary), make("div", region, make("pre", {}, text)));
}

/** A link that saves a text as a file. */
export function download(name, text, type) {
  const href = URL.createObjectURL(new Blob([text], { type }));
  return make("a", { href, download: name, className: "button" }, `Save ${name}`);
}

function fill(element, attributes, ...children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (name in element && !(element instanceof SVGElement)) element[name] = value;
    else element.setAttribute(name, value);
  }
  element.append(...children.filter((child) => child !== ""));
  return element;
}
