// The output pane: feeds, override, force and its set point, lamp of the limits.

import { announce, byId, el, figure, fixed, number } from "/dashboard/app.js";
import { switchField } from "/dashboard/control_fields.js";
import { measured, placesOf, unitOf } from "/dashboard/units.js";

const FEEDS = [
  ["feed_programmed_mm_min", "Programmed feed", "mm/min"],
  ["feed_advised_mm_min", "Advised feed", "mm/min"],
  ["feed_actual_mm_min", "Actual feed", "mm/min"],
  ["override_percent", "Override", "%"],
];

/** Small figures by kind of run: [name in the status, label, unit, decimals or undefined]. */
const SMALL = {
  "trial": [
    ["power_predicted_kw", "Predicted power", "kW", 2],
    ["power_kw", "Drive power", "kW", 2],
    ["force_predicted_n", "Predicted force", "N", 0],
    ["force_measured_n", "Measured force", "N", 0],
    ["feed_per_tooth_mm", "Feed per tooth", "mm", 3],
    ["removal_rate_cm3_min", "Removal rate", "cm³/min", 1],
    ["specific_cutting_force_n_mm2", "Specific force", "N/mm²", 0],
  ],
  "control-run": [
    ["power_kw", "Drive power", "kW", 2],
    ["motor_power_kw", "Available power", "kW", 2],
    ["force_expected_n", "Expected force", "N", 0],
    ["force_measured_n", "Measured force", "N", 0],
    ["removal_rate_cm3_min", "Removal rate", "cm³/min", 1],
    ["axial_depth_mm", "Actual depth", "mm", 2],
    ["flank_wear_mm", "Estimated wear", "mm", 2],
  ],
};
const BAR_TOP = 1.5;
/** share of the set point above which bar and lamp say so; noise about the set point stays below */
const NEAR = 1.02;
/** values of a machine at rest, regardless of its last sample */
const AT_REST = { feed_actual_mm_min: 0, feed_per_tooth_mm: 0, removal_rate_cm3_min: 0, force_measured_n: 0,
  force_predicted_n: 0, power_kw: 0, power_predicted_kw: 0 };
/** values that are blank while the loop is off */
const OFF = { feed_advised_mm_min: null };

/** Return the words on a force above its set point, with number and time. */
function overWords({ over_set_point_percent: percent, over_set_point_s: seconds }) {
  return `OVER SET POINT ${fixed(percent, 0)} % for ${fixed(Math.floor(seconds), 0)} s`;
}

/** Return the force as a share of its set point; null if one of them is not known. */
function shareOf(status) {
  const force = status?.force_measured_n, aim = status?.force_set_point_n;
  return Number.isFinite(force) && aim ? Math.max(force, 0) / aim : null;
}

function named(name, words, unit, kind) {
  const node = figure(words, "–", unitOf(unit), kind);
  const value = node.querySelector(".value");
  value.id = `out-${name}`;
  node.dataset.name = name;
  return { node, put: (text) => { if (value.textContent !== text) value.textContent = text; } };
}

/** Create the pane; `ask(name, value)` receives changes of the switches. */
export class Output {
  constructor(ask) {
    this.isOn = switchField({ name: "is_on", words: "loop on or off" },
      [[true, "ON", "the loop sets the feed"], [false, "OFF", "programmed feed, regardless of the force"]], ask);
    this.mode = switchField({ name: "mode", words: "mode" },
      [["TC", "TC", "time-critical: as fast as the limits allow"],
        ["QC", "QC", "quality-critical: the programmed chip load"]], ask);
    this.feeds = FEEDS.map(([name, words, unit]) => named(name, words, unit, "big"));
    this.lampWord = el("span", { class: "word" }, "–");
    this.lamp = el("div", { class: "lamp idle", id: "lamp", role: "img", "aria-label": "limits: no run" },
      el("span", { class: "cap" }, "Limits"), this.lampWord);
    this.depth = el("div", { id: "depth-warning", class: "depth" });
    this.holding = el("b", { id: "out-holding" }, "–");
    this.forceText = el("span", { id: "out-force" }, "–");
    this.fillBar = el("div", { class: "fill" });
    this.bar = el("div", { class: "meter", role: "meter", id: "force-bar", "aria-label": "force relative to set point",
      "aria-valuemin": "0", "aria-valuemax": "150" }, this.fillBar, el("div", { class: "aim" }));
    this.small = el("div", { class: "figures small-figures", id: "out-small" });
    this.glance = el("div", { class: "glance", id: "glance", "aria-hidden": "true" });
    this.kind = "";
    this.node = el("section", { class: "card output", id: "output", "aria-labelledby": "output-title" },
      el("h2", { id: "output-title", class: "unseen" }, "Output"),
      el("div", { class: "top" }, el("div", { class: "figures feeds" }, this.feeds.map((each) => each.node)),
        this.lamp),
      el("div", { class: "middle" },
        el("div", { class: "force" },
          el("div", { class: "soft" }, "Cutting force ", this.forceText), this.bar,
          el("div", { class: "soft" }, "Feed limited by ", this.holding), this.depth),
        el("div", { class: "switches" }, this.isOn.node, this.mode.node)),
      this.small);
  }

  /** Show the figures of another kind of run. */
  shape(kind) {
    if (kind === this.kind) return;
    this.kind = kind;
    this.smalls = SMALL[kind].map(([name, words, unit, places]) => ({ name, unit, places, ...named(name, words, unit, "") }));
    this.small.replaceChildren(...this.smalls.map((each) => each.node));
  }

  /** Show the status of the run; null: no run. `isOver`: the status is final. */
  show(last, isOver) {
    const isAtRest = isOver || Boolean(last?.is_stopped);
    const status = last && { ...last, ...(isAtRest ? AT_REST : {}), ...(last.is_on === false ? OFF : {}) };
    this.node.classList.toggle("over-now", isOver || !status);
    const feeds = FEEDS.map(([name, , unit]) => measured(status?.[name], unit));
    this.feeds.forEach((each, at) => each.put(fixed(feeds[at], Math.abs(feeds[at]) < 100 && at < 3 ? 1 : 0)));
    for (const { name, unit, places, put } of this.smalls) put(fixed(measured(status?.[name], unit), placesOf(places, unit)));
    this.showForce(status);
    this.put(this.holding, !status ? "–" : (status.holding || "nothing"));
    this.showLamp(status, isAtRest);
    this.glance.hidden = !status || isOver;
    this.glance.className = `glance ${this.lamp.classList[1]}`;
    this.put(this.glance, `${this.lampWord.textContent} · ${fixed(feeds[2], 0)} ${unitOf("mm/min")} · `
      + `${fixed(status?.force_measured_n, 0)} N`);
    const warning = status?.depth_warning ? `Warning: ${status.depth_warning}` : "";
    if (this.depth.textContent !== warning) {
      this.depth.textContent = warning;
      if (warning) announce(warning);
    }
  }

  put(place, text) { if (place.textContent !== text) place.textContent = text; }

  showForce(status) {
    const force = status?.force_measured_n, aim = status?.force_set_point_n;
    const share = shareOf(status);
    const of = aim ? `of ${fixed(aim, 0)} N set point` : "no set point";
    this.put(this.forceText, !Number.isFinite(force) ? "–"
      : `${fixed(force, 0)} N ${of}${share === null ? "" : `, ${fixed(100 * share, 0)} %`}`);
    this.fillBar.style.transform = `scaleX(${Math.min(share ?? 0, BAR_TOP) / BAR_TOP})`;
    const tone = share > 1.1 ? "over" : share > NEAR ? "near" : "";
    this.bar.className = `meter ${tone}`;
    this.bar.setAttribute("aria-valuenow", number(100 * (share ?? 0), 3));
  }

  showLamp(status, isAtRest) {
    const [tone, word] = !status ? ["idle", "NO RUN"] : isAtRest ? ["idle", "AT REST"]
      : status.is_overloaded ? ["over", "OVER POWER"]
        : status.over_set_point_s ? ["over", overWords(status)]
          : status.is_override_followed === false ? ["over", "NOT FOLLOWED"]
            : shareOf(status) > NEAR ? ["near", "ABOVE SET POINT"] : ["safe", "SAFE"];
    if (this.lampWord.textContent === word) return;
    // Numbers that count on are not announced each time.
    if (word.split(" ")[0] !== this.lampWord.textContent.split(" ")[0]) announce(`limits: ${word}`);
    this.lampWord.textContent = word;
    this.lamp.className = `lamp ${tone}`;
    this.lamp.classList.toggle("long", word.length > 10);
    this.lamp.setAttribute("aria-label", `limits: ${word}`);
  }
}

/** Banner that warns of old data; the data are greyed out. */
export class Freshness {
  constructor() {
    this.age = el("span", { id: "stale-age" });
    this.node = el("div", { class: "stale-banner", id: "stale", role: "alert", hidden: true });
    this.isStale = false;
  }

  show(age, isLost) {
    const isStale = age !== null;
    if (isStale) this.age.textContent = `last data ${fixed(Math.floor(age), 0)} s ago`;
    if (isStale === this.isStale && isLost === this.isLost) return;
    this.isStale = isStale;
    this.isLost = isLost;
    byId("main").classList.toggle("is-stale", isStale);
    this.node.hidden = !isStale;
    // The age is hidden from screen readers, so that the alert is read only once.
    this.age.setAttribute("aria-hidden", "true");
    this.node.replaceChildren(...(isStale ? [el("strong", {}, isLost ? "CONNECTION LOST" : "NO DATA"),
      el("span", {}, isLost ? "the service does not answer; the run may still be running" : "the values are out of date"),
      this.age] : []));
    if (!isStale) announce("receiving data again");
  }
}
