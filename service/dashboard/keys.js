// The keyboard map: `?` shows it; single keys can be switched off in it.

const KEPT = "stepnc.keys";
const FIELDS = "input, select, textarea, [contenteditable]";
const more = [];

/** Add a key of the page shown: [key, words, action]. */
export const addKey = (key, words, action) => more.push([key, words, action]);

/** Listen to the keys of all pages; `el` makes elements, `pages` = [[name, text]]. */
export function listen(el, pages, actions) {
  const jump = pages.map(([name, text], at) => [String(at + 1), `page ${text}`,
    () => { location.href = `/dashboard/${name}.html`; }]);
  const all = () => [...jump, ...actions, ...more];
  const areOn = () => localStorage.getItem(KEPT) !== "off";

  function show() {
    if (document.getElementById("key-map")) return;
    const on = el("input", { type: "checkbox", id: "keys-on", checked: areOn(),
      onchange: () => localStorage.setItem(KEPT, on.checked ? "on" : "off") });
    const row = ([key, words]) => el("tr", {}, el("th", { scope: "row" }, el("kbd", {}, key)), el("td", {}, words));
    const dialog = el("dialog", { id: "key-map", "aria-labelledby": "key-map-title" },
      el("h2", { id: "key-map-title" }, "Keyboard"),
      el("table", {}, el("tbody", {}, [["?", "this map"], ...all(), ["Tab", "the next field or button"],
        ["↑ ↓", "in a table of workingsteps: the next; in a number: one step"], ["Esc", "close this"]].map(row))),
      el("p", {}, el("label", { class: "inline" }, on, "single keys act")),
      el("p", { class: "row" }, el("button", { type: "button", class: "main", autofocus: true,
        onclick: () => dialog.close() }, "Close")));
    dialog.addEventListener("close", () => dialog.remove());
    document.body.append(dialog);
    dialog.showModal();
  }

  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.target.closest?.(FIELDS)
      || document.querySelector("dialog[open]")) return;
    if (event.key === "?") { event.preventDefault(); show(); return; }
    const found = areOn() && all().find(([key]) => key === event.key);
    if (found) { event.preventDefault(); found[2](); }
  });
  return show;
}
