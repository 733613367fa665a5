// The operator's card: Hold, Resume, greatest override, remaining time, and alarms until acknowledged.

import { announce, el, duration, fill, fixed } from "/dashboard/app.js";

/** alarms by kind of event: what the rule is, in words */
const RULES = { over: "Limit exceeded", hold: "Overload: the loop holds the feed",
  stop: "The loop has stopped the program", breakage: "Tooth broken", lost: "Machine lost",
  silence: "No force reading", "not followed": "Override not followed", unreachable: "Set point out of reach",
  wear: "Tool worn" };
const WARNINGS = ["warning", "hardness", "averaged", "refused"], SHOWN = 3;
const KEPT = "stepnc.acknowledged", RUNS_KEPT = 30, BEEP_MS = 3000;

const read = () => JSON.parse(localStorage.getItem(KEPT) ?? "{}");

/** Ask a question in a dialog; resolves to whether the answer is yes. */
export function question(id, text, more, yes, no) {
  return new Promise((done) => {
    const dialog = el("dialog", { id, "aria-labelledby": `${id}-text` }, el("h2", { id: `${id}-text` }, text),
      el("p", {}, more), el("p", { class: "row" },
        el("button", { type: "button", autofocus: true, id: `${id}-no`, onclick: () => dialog.close() }, no),
        el("button", { type: "button", class: "main", id: `${id}-yes`, onclick: () => dialog.close("yes") }, yes)));
    dialog.addEventListener("close", () => { dialog.remove(); done(dialog.returnValue === "yes"); });
    document.body.append(dialog);
    dialog.showModal();
  });
}

/** Alarms of a run, one for each kind, shown until acknowledged, also after a reload. */
export class Alarms {
  constructor() {
    this.list = el("ul", { class: "plain", id: "alarm-list" });
    this.node = el("section", { id: "alarms", role: "alert", "aria-label": "alarms", hidden: true }, this.list);
    this.sound = el("button", { type: "button", id: "alarm-sound", "aria-pressed": "false",
      onclick: () => this.toggleSound() }, "Sound of alarms");
    this.notify = el("button", { type: "button", id: "alarm-notify", "aria-pressed": "false",
      onclick: () => this.toggleNotify() }, "Notify me");
    if (!("Notification" in window)) {
      this.notify.disabled = true;
      this.notify.title = "this browser notifies only over https or on this computer";
    }
    this.run = "";
    this.open = new Map();
  }

  /** Show the alarms among all events of a run. `isLive`: they are news, which are told aloud. */
  show(run, events, isLive) {
    if (run !== this.run) { this.run = run; this.open.clear(); }
    const seen = read()[run] ?? {}, before = this.open;
    this.open = new Map();
    for (const event of events) {
      if (!(event.kind in RULES) || event.time_s <= (seen[event.kind] ?? -1)) continue;
      this.open.set(event.kind, { ...event, count: (this.open.get(event.kind)?.count ?? 0) + 1 });
    }
    const fresh = [...this.open.values()].filter((each) => before.get(each.kind)?.count !== each.count);
    if (!fresh.length && before.size === this.open.size) return;
    this.draw();
    if (isLive) for (const each of fresh) this.call(each);
  }

  draw() {
    this.node.hidden = this.open.size === 0;
    fill(this.list, [...this.open.values()].map((each) => el("li", { "data-kind": each.kind },
      el("span", {}, el("strong", {}, RULES[each.kind]), each.count > 1 ? ` (${each.count} times)` : "",
        el("span", { class: "text" }, `${each.text}, at ${fixed(each.time_s, 1)} s`)),
      el("button", { type: "button", onclick: () => this.acknowledge(each.kind) }, "Acknowledge"))));
    clearInterval(this.timer);
    if (this.open.size && this.pen) this.timer = setInterval(() => this.beep(), BEEP_MS);
  }

  acknowledge(kind) {
    const all = read();
    const { [this.run]: seen, ...others } = all;
    const kept = Object.entries(others).slice(1 - RUNS_KEPT);
    localStorage.setItem(KEPT, JSON.stringify({ ...Object.fromEntries(kept),
      [this.run]: { ...seen, [kind]: this.open.get(kind).time_s } }));
    this.open.delete(kind);
    this.draw();
    announce("alarm acknowledged");
  }

  call(event) {
    this.beep();
    if (this.isNotifying) new Notification(RULES[event.kind], { body: event.text, tag: `${this.run}-${event.kind}` });
  }

  beep() {
    if (!this.pen) return;
    const tone = this.pen.createOscillator(), loud = this.pen.createGain();
    loud.gain.value = 0.2;
    tone.frequency.value = 880;
    tone.connect(loud).connect(this.pen.destination);
    tone.start();
    tone.stop(this.pen.currentTime + 0.4);
  }

  toggleSound() {
    this.pen?.close();
    this.pen = this.pen ? null : new AudioContext();
    this.sound.setAttribute("aria-pressed", String(this.pen !== null));
    this.draw();
    this.beep();
  }

  async toggleNotify() {
    this.isNotifying = !this.isNotifying && await Notification.requestPermission() === "granted";
    this.notify.setAttribute("aria-pressed", String(this.isNotifying));
    if (Notification.permission === "denied") announce("the browser refuses notifications of this page");
  }
}

/** Create the card of a program under control; `ask(name, value, isAtOnce)` receives orders. */
export function operatorCard(ask, alarms) {
  let isEnabled = false, isHeld = false;
  const hold = el("button", { type: "button", id: "hold", class: "hold", onclick: () => ask("is_held", true, true) }, "Hold");
  const resume = el("button", { type: "button", id: "resume", onclick: () => ask("is_held", false, true) }, "Resume");
  const slider = el("input", { type: "range", id: "in-override_most_percent", min: 1, max: 120, step: 1, value: 120,
    "aria-describedby": "override-state", oninput: () => ask("override_most_percent", slider.valueAsNumber) });
  const state = el("output", { id: "override-state" }, "–");
  const note = el("p", { class: "bad", id: "operator-note", role: "alert", hidden: true });
  const remaining = el("output", { id: "out-remaining_s", class: "value" }, "–");
  const finish = el("output", { id: "out-finish", class: "value" }, "–");
  const warnings = el("ul", { class: "plain small", id: "warnings" });
  const refuse = (text) => { note.textContent = text ?? ""; note.hidden = !text; };
  const enable = (isFree) => {
    isEnabled = isFree;
    hold.disabled = !isFree || isHeld;
    resume.disabled = !isFree || !isHeld;
    slider.disabled = !isFree;
  };
  enable(false);
  const node = el("section", { class: "card operator", id: "operator", "aria-labelledby": "operator-title" },
    el("h2", { id: "operator-title" }, "Operator"),
    el("div", { class: "orders" }, hold, resume,
      el("label", { class: "most", for: slider.id }, el("span", {}, "Override at most ", state), slider),
      el("span", { class: "small", id: "no-emergency-stop" }, el("strong", {}, "Not an emergency stop."),
        " Hold acts on the feed alone, within a tenth of a second; a rapid goes on to its end.")),
    note,
    el("div", { class: "row" }, el("span", {}, "Remaining, at the programmed feeds ", remaining),
      el("span", {}, "Finished about ", finish), alarms.sound, alarms.notify),
    el("h3", {}, "Warnings"), warnings);
  return {
    node,
    fields: [
      { spec: { name: "is_held" }, refuse, enable, show(value, isPending) {
        isHeld = Boolean(value);
        hold.classList.toggle("pending", Boolean(isPending));
        enable(isEnabled);
      } },
      { spec: { name: "override_most_percent" }, refuse, enable() {}, show(value, isPending) {
        if (document.activeElement !== slider || !isPending) slider.value = value;
        state.textContent = `${fixed(value, 0)} %${isPending ? ", pending" : ""}`;
      } },
    ],
    /** Show the status of the run, at a pace. */
    show(status, isOver) {
      if (status?.override_ceiling_percent) slider.max = Math.floor(status.override_ceiling_percent);
      const isEnded = isOver || Boolean(status?.is_stopped), left = isEnded ? null : status?.remaining_s;
      remaining.textContent = duration(left);
      finish.textContent = !status || isEnded ? "–" : status.is_held ? "held"
        : status.pace ? new Date(Date.now() + 1000 * left / status.pace).toLocaleTimeString("en-GB") : "at once";
    },
    warn(events) {
      const last = events.filter((event) => WARNINGS.includes(event.kind)).slice(-SHOWN).reverse();
      fill(warnings, last.length ? last.map((event) => el("li", {}, el("b", {}, `${event.kind}: `),
        `${event.text}, at ${fixed(event.time_s, 1)} s`)) : el("li", { class: "soft" }, "none"));
    },
  };
}
