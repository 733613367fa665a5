// Units in which figures and tables are shown: metric or inch, remembered in the browser.

const KEPT = "stepnc.units";
/** Factor, unit and further decimals of each metric unit in inch. */
const INCH = { "mm/min": [1 / 25.4, "in/min", 1], mm: [1 / 25.4, "in", 2], "m/min": [1000 / 304.8, "sfm", 0],
  "cm³/min": [1 / 16.387064, "in³/min", 1] };

export const isInch = () => localStorage.getItem(KEPT) === "inch";
const chosen = (unit) => (isInch() && INCH[unit]) || [1, unit, 0];

/** Return the unit in which a metric unit is shown. */
export const unitOf = (unit) => chosen(unit)[1];

/** Return a value in the unit shown; what is no number stays as it is. */
export const measured = (value, unit) => (typeof value === "number" ? value * chosen(unit)[0] : value);

/** Return the decimals that a value needs in the unit shown. */
export const placesOf = (places, unit) => (places === undefined ? places : places + chosen(unit)[2]);

/** Switch between metric and inch; the page is read again in the other units. */
export function toggleUnits() {
  localStorage.setItem(KEPT, isInch() ? "metric" : "inch");
  location.reload();
}
