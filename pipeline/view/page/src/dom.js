// Small pieces of page.

// make("p", {class: "quiet", onclick: f}, "text", child ...)
export function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (name in element && name !== "list") element[name === "class" ? "className" : name] = value;
    else element.setAttribute(name, value);
    if (name === "class") element.className = value;
  }
  element.append(...children.filter((child) => child !== null && child !== undefined));
  return element;
}

export const row = (...children) => make("div", { class: "row" }, ...children);

export function section(title, ...children) {
  return make("section", {}, make("h2", {}, title), ...children);
}

// A switch with its key; set(yes) shows a state without telling of it.
export function switch_of(text, key, changed) {
  const box = make("input", { type: "checkbox", onchange: () => changed(box.checked) });
  const label = make("label", { class: "switch" }, box, text);
  return { element: row(label, key ? make("kbd", {}, key) : null), set: (yes) => (box.checked = yes), box };
}

export function slider_of({ min, max, step, title, changed }) {
  const input = make("input", { type: "range", min, max, step, title, oninput: () => changed(Number(input.value)) });
  input.setAttribute("aria-label", title);
  return input;
}

export const grouped = (number) => Math.round(number).toLocaleString("en").replaceAll(",", "\u202f");

export function bytes_text(bytes) {
  const units = ["B", "KB", "MB", "GB", "TB"];
  let k = 0;
  while (bytes >= 1000 && k + 1 < units.length) {
    bytes /= 1000;
    ++k;
  }
  return `${k === 0 ? bytes : bytes.toPrecision(3)} ${units[k]}`;
}

// A length to five digits.
export const number_text = (number) => Number(number.toPrecision(5)).toString();
