// The form that starts a shop: a sample, or a shop file as text.

import { announce, api, byId, el, fill, tell } from "/dashboard/app.js";

const PACES = [["10", "10 ×"], ["60", "60 ×: a minute a second"], ["300", "300 ×"], ["1000", "1000 ×"],
  ["0", "as fast as possible, with replications"]];
const OWN = "own";

/** Create the form; `started(job)` receives the new run. */
export async function startForm(place, started) {
  const shops = await api("/v1/shops");
  const problem = el("div", { id: "start-problem" });
  const text = el("textarea", { id: "shop-text", rows: "14", spellcheck: "false", "aria-label": "shop file",
    oninput: () => { if (choice.value !== OWN) choice.value = OWN; } });
  const choice = el("select", { id: "shop-choice", onchange: follow },
    shops.map(({ name, title }) => el("option", { value: name }, title)), el("option", { value: OWN }, "own shop file"));
  const file = el("input", { id: "shop-file", type: "file", accept: ".toml,.json", onchange: read });
  const field = (id, label, more) => el("label", {}, label, el("input", { id, type: "number", step: "any", ...more }));
  const pace = el("select", { id: "shop-pace", onchange: follow },
    PACES.map(([value, words]) => el("option", { value, selected: value === "60" }, words)));
  const replications = field("shop-replications", "Replications", { value: "10", min: "1", max: "500" });
  const more = el("details", { class: "more", id: "shop-more" },
    el("summary", {}, "Shop file"),
    el("p", { class: "soft small" }, "TOML or JSON. A program is a sample such as shaft.stpnc or the id of an uploaded one; a machine is one of the library."),
    text, el("label", {}, "or read a file", file));
  fill(place, el("form", { id: "shop-start", onsubmit: submit },
    el("div", { class: "fields" }, el("label", { class: "wide" }, "Shop", choice), el("label", {}, "Pace", pace),
      field("shop-hours", "Hours (empty: as the file)", { min: "0.001" }), field("shop-seed", "Seed", { value: "1", min: "0" }),
      replications),
    more, problem, el("p", {}, el("button", { class: "main", id: "shop-run" }, "Start"))));
  follow();

  function follow() {
    replications.hidden = pace.value !== "0";
    const found = shops.find(({ name }) => name === choice.value);
    if (found) text.value = found.text;
    else more.open = true;
  }

  async function read() {
    if (!file.files[0]) return;
    text.value = await file.files[0].text();
    choice.value = OWN;
  }

  /** Return what the text says: an object if it is JSON, else TOML text. */
  function shop() {
    if (!text.value.trim().startsWith("{")) return text.value;
    try { return JSON.parse(text.value); } catch (error) { throw new Error(`the shop file is not valid JSON: ${error.message}`, { cause: error }); }
  }

  async function submit(event) {
    event.preventDefault();
    tell(problem, null);
    const isOwn = choice.value === OWN, hours = byId("shop-hours").value;
    const button = byId("shop-run");
    button.disabled = true;
    try {
      const json = { ...(isOwn ? { shop: shop() } : { sample: choice.value }), pace: Number(pace.value),
        seed: Number(byId("shop-seed").value), ...(hours ? { hours: Number(hours) } : {}),
        ...(pace.value === "0" ? { replications: Number(byId("shop-replications").value) } : {}) };
      const job = await api("/v1/factories", { method: "POST", json,
        headers: { "idempotency-key": crypto.randomUUID?.() ?? String(Math.random()) } });
      announce("shop started");
      started(job);
    } catch (error) { tell(problem, error); } finally { button.disabled = false; }
  }
}
