// Elements, and the colors of the page as it is now.

export function element(name, attributes = {}, children = []) {
  const out = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) out.setAttribute(key, value);
  out.append(...children);
  return out;
}

export function option(value, text) {
  return element("option", { value: String(value) }, [text]);
}

let next = 0;
/** A control with its name, and, where there is one, what it says beside that. */
export function control(name, input, beside) {
  input.id = `control-${++next}`;
  const label = element("label", { for: input.id }, [name]);
  return element("span", { class: "control" }, [beside ? element("span", {}, [label, " ", beside]) : label, input]);
}

function rgb(text) {
  const hex = text.trim().replace("#", "");
  return [0, 2, 4].map((k) => parseInt(hex.substr(k, 2), 16) / 255);
}

/** The custom properties of the style sheet, as strings, and two of them as numbers from 0 to 1. */
export function theme(root) {
  const style = getComputedStyle(root);
  const get = (name) => style.getPropertyValue(name).trim();
  const [ink, paper] = [get("--ink"), get("--paper")];
  return { ink, paper, dim: get("--dim"), rule: get("--rule"), bad: get("--bad"), good: get("--good"), load: get("--load"), support: get("--support"),
           lines: ["--one", "--two", "--three", "--four"].map(get), inkRgb: rgb(ink), paperRgb: rgb(paper) };
}
