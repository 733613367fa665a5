// Shared by all pages: frame, requests, event streams, formatting of numbers.

import { listen } from "/dashboard/keys.js";
import { isInch, toggleUnits } from "/dashboard/units.js";

const PAGES = [
  ["plan", "Plan"], ["control", "Control"], ["machine", "Machine"],
  ["factory", "Factory"], ["verify", "Verify"], ["knowledge", "Knowledge"], ["jobs", "Jobs"],
];
const MANUAL = "/manual/index.html";
const KEY = "stepnc.key", THEME = "stepnc.theme";
/** HTTP status codes of a service that is starting or stopping */
const AWAY = [502, 503, 504];
/** message while the service does not answer */
export const AWAY_WORDS = "Connection lost; trying again every second.";

// -- elements ---------------------------------------------------------------------------------

/** Create an element with attributes, `on…` listeners and children (strings become text, never HTML). */
export function el(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === undefined || value === null || value === false) continue;
    if (name.startsWith("on")) made.addEventListener(name.slice(2), value);
    else if (name === "class") made.className = value;
    else if (name in made && typeof value !== "string") made[name] = value;
    else made.setAttribute(name, value === true ? "" : value);
  }
  made.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return made;
}

export const byId = (id) => document.getElementById(id);

/** Replace the children of an element. */
export function fill(place, ...children) {
  place.replaceChildren(...children.flat().filter((child) => child !== null && child !== undefined));
}

/** Create a labelled figure; its value can be updated through the class `value`. */
export function figure(name, value, unit = "", kind = "") {
  return el("div", { class: `figure ${kind}` }, el("div", { class: "name" }, name),
    el("div", {}, el("span", { class: "value" }, value), el("span", { class: "unit" }, unit)));
}

// -- formatting of numbers ----------------------------------------------------------------------

/** Format a number with significant digits; a dash if there is none. */
export function number(value, digits = 3) {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  const size = Math.abs(value);
  if (size !== 0 && (size >= 1e7 || size < 1e-4)) return value.toExponential(digits - 1);
  const places = size === 0 ? 0 : Math.max(0, digits - 1 - Math.floor(Math.log10(size)));
  return value.toLocaleString("en-GB", { maximumFractionDigits: places, useGrouping: size >= 1e4 });
}

export function fixed(value, places) {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  // Avoid a minus sign before zero.
  const told = Math.abs(value) < 0.5 * 10 ** -places ? 0 : value;
  return told.toLocaleString("en-GB",
    { minimumFractionDigits: places, maximumFractionDigits: places, useGrouping: Math.abs(value) >= 1e4 });
}

const two = (count) => String(count).padStart(2, "0");

/** Format a duration in s, in the units suited to `like` s, so that two can be compared. */
export function duration(seconds, like = seconds) {
  if (seconds === null || seconds === undefined) return "–";
  if (like < 120) return `${fixed(seconds, 1)} s`;
  const whole = Math.round(seconds), minutes = Math.floor(whole / 60);
  if (whole < 60) return `${whole} s`;
  if (like < 3600) return `${minutes} min ${two(whole % 60)} s`;
  return `${Math.floor(minutes / 60)} h ${two(minutes % 60)} min`;
}

/** Return a number with its noun, which takes an s unless there is one of it. */
export const counted = (count, noun) => `${count.toLocaleString("en-GB")} ${noun}${count === 1 ? "" : "s"}`;

export const percent = (share, places = 0) =>
  share === null || share === undefined ? "–" : `${fixed(100 * share, places)} %`;

/** Format a date and time, alike on all pages. */
export const moment = (text) => (text ? new Date(text).toLocaleString("en-GB", { day: "numeric",
  month: "short", year: "numeric", hour: "2-digit", minute: "2-digit", second: "2-digit" }) : "–");

/** Return an EXPRESS or limit name with spaces. */
export const words = (name) => (name ?? "").replaceAll("_", " ");

// -- requests ---------------------------------------------------------------------------------

export class Problem extends Error {
  constructor(body, status) {
    super(body.detail ?? body.title ?? `HTTP ${status}`);
    this.body = body;
    this.status = status;
  }
}

const keptKey = () => sessionStorage.getItem(KEY);

async function ask(path, options = {}) {
  const { json, headers = {}, ...rest } = options;
  const sent = json === undefined ? headers : { "content-type": "application/json", ...headers };
  const body = json === undefined ? rest.body : JSON.stringify(json);
  const key = keptKey();
  const answer = await fetch(path, { ...rest, body,
    headers: key ? { ...sent, authorization: `Bearer ${key}` } : sent });
  if (answer.status === 401) {
    // Another request may have obtained a key meanwhile.
    if (key === keptKey()) await askForKey(key ? "This key was refused" : "A key is needed");
    return ask(path, options);
  }
  if (answer.ok) return answer;
  const type = answer.headers.get("content-type") ?? "";
  const problem = type.includes("json") ? await answer.json() : { detail: await answer.text() };
  throw new Problem(problem, answer.status);
}

/** Send a request, with `json` as the body if given; return the JSON answer, or null without one. */
export async function api(path, options = {}) {
  const answer = await ask(path, options);
  return answer.status === 204 ? null : answer.json();
}

/** Download a resource as a file, with the key, which a plain link would not send. */
export async function save(path) {
  const answer = await ask(path);
  const named = /filename="([^"]+)"/.exec(answer.headers.get("content-disposition") ?? "");
  const link = el("a", { href: URL.createObjectURL(await answer.blob()),
    download: named ? named[1] : path.split("/").pop() });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/** Open a report in a new window. */
export async function show(path) {
  const opened = window.open("about:blank", "_blank");
  if (!keptKey() && opened) { opened.location = path; return; }
  opened?.close();
  await save(path);
}

// -- the key ----------------------------------------------------------------------------------

let asking = null;
/** Ask for the API key in a dialog shared by all waiting requests. `others`: further buttons. */
function askForKey(title, others = []) {
  asking ??= new Promise((done) => {
    const field = el("input", { type: "password", autocomplete: "off", required: true, id: "key-field" });
    const dialog = el("dialog", { id: "key-dialog", "aria-labelledby": "key-title" },
      el("h2", { id: "key-title" }, title),
      el("p", { class: "soft" }, "Create a key with “stepnc keys create”. The key is kept until this window is closed."),
      el("form", { method: "dialog", onsubmit: () => sessionStorage.setItem(KEY, field.value.trim()) },
        el("label", {}, "Key", field),
        el("p", { class: "row" }, el("button", { class: "main", id: "key-use" }, "Use key"), others)));
    dialog.addEventListener("close", () => {
      dialog.remove();
      asking = null;
      byId("key").hidden = !keptKey();
      done();
    });
    document.body.append(dialog);
    dialog.showModal();
  });
  return asking;
}

/** Let the user change or forget the API key. */
function changeKey() {
  const forget = () => { sessionStorage.removeItem(KEY); location.reload(); };
  return askForKey("The key of this window", [
    el("button", { type: "button", id: "key-forget", onclick: forget }, "Forget key"),
    el("button", { type: "button", id: "key-leave",
      onclick: (event) => event.target.closest("dialog").close() }, "Cancel")]);
}

// -- streams ----------------------------------------------------------------------------------

/**
 * Watch a job: `handlers` by event (`job`, `status`, `rows`, `event`, `gap`), `lost` when the
 * connection breaks, `back` when it is restored, `end` when the job has ended. Returns a function that stops watching.
 */
export const watch = (id, handlers) => watchAt(`/v1/jobs/${id}/events`, handlers);

/** Watch an event stream at a path, see `watch`. */
export function watchAt(path, handlers) {
  const stop = new AbortController();
  let isOver = false, wasLost = false;
  (async () => {
    while (!stop.signal.aborted && !isOver) {
      try {
        const answer = await ask(path, { signal: stop.signal });
        if (wasLost) handlers.back?.();
        wasLost = false;
        for await (const [name, content] of messages(answer.body)) {
          if (name === "job") isOver = ["succeeded", "failed", "cancelled"].includes(content.state);
          handlers[name]?.(content);
          handlers.any?.();
        }
      } catch (error) {
        if (stop.signal.aborted) return;
        if (error instanceof Problem && error.status === 404) isOver = true;
        else { wasLost = true; handlers.lost?.(error); }
      }
      if (!isOver) await new Promise((again) => setTimeout(again, 1000));
    }
    if (!stop.signal.aborted) handlers.end?.();
  })();
  return () => stop.abort();
}

async function* messages(body) {
  const reader = body.pipeThrough(new TextDecoderStream()).getReader();
  let rest = "";
  while (true) {
    const { value, done } = await reader.read();
    if (done) return;
    rest += value;
    for (let end = rest.indexOf("\n\n"); end >= 0; end = rest.indexOf("\n\n")) {
      const block = rest.slice(0, end);
      rest = rest.slice(end + 2);
      const name = /^event: (.*)$/m.exec(block)?.[1], data = /^data: (.*)$/m.exec(block)?.[1];
      if (name && data) yield [name, JSON.parse(data)];
    }
  }
}

/** Get JSON, retrying while the service does not answer; `lost` and `back` are called meanwhile. */
export async function patiently(path, { lost, back }) {
  for (let isLost = false; ; isLost = true) {
    try {
      const found = await api(path);
      if (isLost) back();
      return found;
    } catch (error) {
      if (error instanceof Problem && !AWAY.includes(error.status)) throw error;
      lost();
      await new Promise((again) => setTimeout(again, 1000));
    }
  }
}

/** Queue a job and wait for its end; `tell` receives its progress. Throws the problem of a failed job. */
export async function done(path, json, tell = () => {}) {
  const asked = await api(path, { method: "POST", json,
    headers: { "idempotency-key": crypto.randomUUID?.() ?? String(Math.random()) } });
  tell(asked);
  return followed(asked, tell);
}

/** Wait for the end of a job; `lost` and `back` are called when the connection breaks and returns. */
export function followed(asked, tell = () => {}, { lost, back } = {}) {
  return new Promise((resolve, reject) => {
    let last = asked;
    watch(asked.id, {
      lost, back,
      job: (job) => { last = job; tell(job); },
      end: async () => {
        last = await api(`/v1/jobs/${asked.id}`).catch(() => last);
        if (last.state === "succeeded") resolve(last);
        else reject(new Problem(last.problem ?? { detail: `the job is ${last.state}` }, 0));
      },
    });
  });
}

// -- the frame --------------------------------------------------------------------------------

/** Announce a text to screen readers. */
export function announce(text) {
  const place = byId("said");
  if (place) place.textContent = text;
}

/** Show a problem in an element of the page; clear it with null. */
export function tell(place, error) {
  if (!error) { fill(place); return; }
  const detail = error instanceof Problem ? error.message : `the service does not answer (${error.message})`;
  const other = error.status === 403 && keptKey()
    ? el("button", { onclick: () => changeKey().then(() => fill(place)) }, "Use another key") : null;
  fill(place, el("div", { class: `banner bad ${other ? "row" : ""}`, role: "alert" }, detail, other));
}

function theme() {
  const wanted = localStorage.getItem(THEME);
  const isDark = wanted ? wanted === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
  document.documentElement.dataset.theme = isDark ? "dark" : "light";
  return isDark;
}

function frame() {
  theme();
  const at = location.pathname.split("/").pop().replace(".html", "");
  const links = PAGES.map(([name, text]) => el("a", { href: `/dashboard/${name}.html`,
    "aria-current": name === at ? "page" : undefined }, text));
  const turn = () => {
    localStorage.setItem(THEME, theme() ? "light" : "dark");
    theme();
    document.dispatchEvent(new Event("theme"));
  };
  const toggle = el("button", { class: "plain", "aria-label": "switch between light and dark",
    title: "switch between light and dark", onclick: turn }, "◐");
  const units = el("button", { class: "plain small", id: "units-shown", title: "switch between metric and inch",
    "aria-label": `units: ${isInch() ? "inch" : "metric"}`, onclick: toggleUnits }, isInch() ? "inch" : "mm");
  const showKeys = listen(el, PAGES, [["m", "manual", () => { location.href = MANUAL; }],
    ["u", "metric or inch", toggleUnits], ["d", "light or dark", turn]]);
  const keys = el("button", { class: "plain", id: "keys", "aria-label": "keyboard map", title: "keyboard map (?)",
    onclick: showKeys }, "?");
  const bar = el("header", { class: "bar" },
    el("a", { class: "brand", href: "/dashboard/plan.html" },
      el("img", { src: "/dashboard/icon.svg", alt: "", width: "24", height: "24" }), "stepnc"),
    el("nav", { "aria-label": "pages" }, links),
    el("div", { class: "right" },
      el("button", { class: "plain small", id: "key", hidden: !keptKey(), onclick: changeKey }, "Key"),
      el("a", { class: "small", id: "manual", href: MANUAL }, "Manual"),
      el("a", { class: "small", href: "/v1/openapi.json" }, "API"), units, keys, toggle));
  document.body.prepend(el("a", { class: "skip", href: "#main" }, "skip to content"), bar);
  // What sticks to the top begins below the header, which is higher on narrow screens.
  new ResizeObserver(() => document.documentElement.style.setProperty("--bar", `${bar.offsetHeight}px`)).observe(bar);
  document.body.append(el("div", { id: "said", class: "unseen", role: "status", "aria-live": "polite" }));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    theme();
    document.dispatchEvent(new Event("theme"));
  });
}

frame();
