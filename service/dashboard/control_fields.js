// Fields of the panel: numbers with steppers, choices, switches. Each shows the confirmed value,
// a requested value that is still pending, and why a value was refused.

import { announce, el, fill } from "/dashboard/app.js";

const HOLD_MS = 450, REPEAT_MS = 90, TOLD_MS = 12_000;

/** Read label, unit and bounds of a number from the OpenAPI document. */
export function described(schema, name) {
  const property = schema.properties[name];
  const bounds = property.anyOf?.find((each) => each.type !== "null") ?? property;
  const [, words, unit] = /^(.*?)(?:, ([^,\s]+))?$/.exec(property.description ?? name);
  return { name, words, unit: unit ?? "", isWhole: bounds.type === "integer",
    low: bounds.minimum ?? bounds.exclusiveMinimum ?? 0, high: bounds.maximum, isOpen: bounds.exclusiveMinimum !== undefined };
}

export const boundsOf = (spec) =>
  `${spec.isOpen ? "above " : ""}${spec.low} to ${spec.high} ${spec.unit}`.trim();

const plain = (value) => String(Number(Number(value).toPrecision(6)));

export const same = (one, other) => (typeof one === "number" && typeof other === "number"
  ? Math.abs(one - other) <= 1e-9 * Math.max(1, Math.abs(one)) : one === other);

/** Create the frame of a field: its label, pending state and refusal message. */
function framed(spec, id, ...inside) {
  const state = el("span", { class: "state", id: `${id}-state` }, spec.unit ?? "");
  const note = el("span", { class: "note", id: `${id}-note`, hidden: true,
    onclick: () => { note.hidden = true; } });
  const node = el("div", { class: "field", id: `${id}-field`, "data-field": spec.name },
    el("div", { class: "head" }, el("label", { for: id, title: spec.words }, spec.words), state),
    ...inside, note);
  let timer = null;
  const aim = () => node.querySelector("input, select");
  return {
    node,
    pending(isPending) {
      node.classList.toggle("pending", Boolean(isPending));
      state.textContent = isPending ? "pending" : (spec.unit ?? "");
    },
    /** `isAlso`: another field shows the message already; this one is for screen readers only. */
    refuse(text, isAlso = false) {
      clearTimeout(timer);
      note.textContent = text ?? "";
      note.hidden = !text;
      note.classList.toggle("unseen", isAlso);
      if (text) {
        aim()?.setAttribute("aria-invalid", "true");
        if (!isAlso) announce(`${spec.words}: ${text}`);
        timer = setTimeout(() => this.refuse(null), TOLD_MS);
      } else aim()?.removeAttribute("aria-invalid");
    },
  };
}

/** Create a number field with − and + buttons; `ask(name, value)` receives changes. */
export function numberField(spec, ask) {
  const id = `in-${spec.name}`;
  let shown = null, isHeld = false, timer = null;
  const input = el("input", { id, type: "number", inputmode: spec.isWhole ? "numeric" : "decimal",
    min: spec.low, max: spec.high, step: "any", autocomplete: "off",
    "aria-label": [spec.words, spec.unit].filter(Boolean).join(", "),
    "aria-describedby": `${id}-state ${id}-note` });

  function want(value) {
    frame.refuse(null);
    shown = value;
    input.value = plain(value);
    ask(spec.name, value);
  }
  function typed() {
    const value = input.valueAsNumber;
    if (Number.isNaN(value)) input.value = shown === null ? "" : plain(shown);
    else if (shown === null || !same(value, shown)) want(value);
  }
  function step(sign) {
    if (input.disabled || shown === null) return;
    const steps = shown / spec.step;
    const next = sign > 0 ? Math.floor(steps + 1e-6) + 1 : Math.ceil(steps - 1e-6) - 1;
    const value = Math.min(Math.max(next * spec.step, spec.isOpen ? spec.step : spec.low), spec.high);
    if (!same(value, shown)) want(Number(value.toPrecision(9)));
  }
  function release() { clearTimeout(timer); timer = null; }
  function stepper(sign, text, word) {
    const again = () => { isHeld = true; step(sign); timer = setTimeout(again, REPEAT_MS); };
    return el("button", { type: "button", tabindex: "-1", class: "step", id: `${id}-${word}`,
      "aria-label": `${word} ${spec.words}`, "aria-controls": id,
      onpointerdown: () => { isHeld = false; release(); timer = setTimeout(again, HOLD_MS); },
      onpointerup: release, onpointerleave: release, onpointercancel: release,
      oncontextmenu: (event) => event.preventDefault(),
      onclick: () => { if (!isHeld) step(sign); isHeld = false; } }, text);
  }
  const less = stepper(-1, "−", "decrease"), more = stepper(1, "+", "increase");
  input.addEventListener("change", typed);
  input.addEventListener("focus", () => input.select());
  input.addEventListener("keydown", (event) => {
    if (event.key === "ArrowUp" || event.key === "ArrowDown") {
      event.preventDefault();
      step(event.key === "ArrowUp" ? 1 : -1);
    } else if (event.key === "Escape" && shown !== null) input.value = plain(shown);
  });
  const frame = framed(spec, id, el("div", { class: "stepped" }, less, input, more));
  return { ...frame, spec,
    show(value, isPending) {
      frame.pending(isPending);
      const isTyping = document.activeElement === input && shown !== null
        && input.value !== plain(shown);
      shown = value;
      if (!isTyping) input.value = value === null || value === undefined ? "" : plain(value);
    },
    enable(isEnabled) { for (const each of [input, less, more]) each.disabled = !isEnabled; } };
}

/** Create a select field; `options` = [[value, text]]. */
export function choiceField(spec, options, ask) {
  const id = `in-${spec.name}`;
  const select = el("select", { id, "aria-describedby": `${id}-state ${id}-note`,
    onchange: () => { frame.refuse(null); ask(spec.name, read()); } });
  const read = () => (spec.isNumber ? Number(select.value) : select.value);
  const put = (all) => fill(select, all.map(([value, text]) => el("option", { value: String(value) }, text)));
  put(options);
  const frame = framed(spec, id, select);
  return { ...frame, spec, read, put, select,
    show(value, isPending) {
      frame.pending(isPending);
      if (value === null || value === undefined) return;
      const isKnown = [...select.options].some((option) => option.value === String(value));
      if (!isKnown) select.append(el("option", { value: String(value) }, String(value)));
      if (select.value !== String(value)) select.value = String(value);
    },
    enable(isEnabled) { select.disabled = !isEnabled; } };
}

/** Create a switch of buttons; `options` = [[value, text, title]]. */
export function switchField(spec, options, ask) {
  const buttons = options.map(([value, text, title]) => el("button", { type: "button", title,
    id: `switch-${text.toLowerCase()}`, "aria-label": `${text}: ${title}`, "aria-pressed": "false",
    onclick: () => ask(spec.name, value) }, text));
  const group = el("div", { class: "switch", role: "group", "aria-label": spec.words,
    id: `switch-${spec.name}` }, buttons);
  const note = el("span", { class: "note", id: `switch-${spec.name}-note`, hidden: true });
  return { node: el("div", { class: "switched" }, group, note), spec,
    show(value, isPending) {
      group.classList.toggle("pending", Boolean(isPending));
      options.forEach(([each], at) => buttons[at].setAttribute("aria-pressed", String(each === value)));
    },
    refuse(text) {
      note.textContent = text ?? "";
      note.hidden = !text;
      if (text) { announce(`${spec.words}: ${text}`); setTimeout(() => this.refuse(null), TOLD_MS); }
    },
    enable(isEnabled) { for (const each of buttons) each.disabled = !isEnabled; } };
}

/** Create a checkbox. */
export function checkField(spec, ask) {
  const box = el("input", { type: "checkbox", id: `in-${spec.name}`,
    onchange: () => ask(spec.name, box.checked) });
  return { node: el("label", { class: "inline check" }, box, spec.words), spec,
    show(value) { box.checked = Boolean(value); },
    refuse() {},
    enable(isEnabled) { box.disabled = !isEnabled; } };
}

/** Create a read-only value reported by the run. */
export function told(name, words, unit = "") {
  const value = el("output", { id: `told-${name}`, class: "value" }, "–");
  return { node: el("div", { class: "field told" }, el("div", { class: "head" },
    el("span", {}, words), el("span", { class: "state" }, unit)), value),
    show(text) { value.textContent = text || "–"; value.title = text || ""; } };
}
