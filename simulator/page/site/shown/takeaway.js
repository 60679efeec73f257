// Files to save: the sweep as CSV, the scene as TOML.

import { parallelCapacitance, readAt } from "rcskin/skin";

/** @typedef {import("rcskin/model").Complex} Complex */
/** @typedef {import("rcskin/skin").Touch} Touch */
/** @typedef {import("rcskin/state").State} State */

const HEADER = "sweep,press,row,column,interface,frequency_Hz,Rs_ohm,X_ohm,Cp_F";

/** Press as rcskin's commands take it. @param {Touch[]} touches */
export function pressText(touches) {
  const each = touches.map((touch) => {
    const where = touch.row
      ? `${touch.row},${touch.column}`
      : `rect(${[touch.x, touch.y, touch.width, touch.height].map(short).join(",")})`;
    return `${where}:${short(touch.factor)}${touch.finger ? `:${short(touch.finger)}F` : ""}`;
  });
  return each.join("+") || "none";
}

/** Sweeps in the form of rcskin's files. @param {any} data @param {{touches: Touch[], Z: Complex[][]}[]} sweeps Z by interface and frequency, ohm */
export function csv(data, sweeps) {
  const lines = sweeps.flatMap(({ touches, Z }, sweep) => {
    const [row, column] =
      touches.length === 1 && touches[0].row
        ? [touches[0].row, touches[0].column]
        : touches.length
          ? [-1, -1]
          : [0, 0];
    return Z.flatMap((values, drive) =>
      readAt(data, drive, [...values.keys()]).map((k) => {
        const [f, z] = [data.frequencies[k], values[k]];
        const named = [
          sweep,
          quoted(pressText(touches)),
          row,
          column,
          quoted(data.interfaces[drive].name),
        ];
        return [...named, f, z.re, z.im, parallelCapacitance(z, f)].join(",");
      }),
    );
  });
  return `${[HEADER, ...lines].join("\n")}\n`;
}

/** Scene as the sliders set it. @param {any} data @param {State} state */
export function toml(data, state) {
  const scene = structuredClone(data.scene);
  for (const name of /** @type {const} */ (["top", "bottom"]))
    scene.skin[name].sheet_resistance *= state[name];
  for (const contact of scene.contact)
    if (contact.resistance)
      contact.resistance *= contact.electrode === "top" ? state.top : state.bottom;
  scene.skin.foam.capacitance_per_area *= state.capacitance;
  scene.skin.foam.loss_tangent = state.loss;
  scene.press = { ...scene.press, capacitance_factor: state.factor };
  if (!state.earthed) delete scene.press.finger;
  else scene.press.finger ??= "earthed";
  const read = state.drives.map((drive) => readAt(data, drive, state.frequencies));
  const asked = state.frequencies.filter((k) => read.some((own) => own.includes(k)));
  const hertz = (/** @type {number[]} */ numbers) => numbers.map((k) => data.frequencies[k]);
  scene.sweep = { frequencies: hertz(asked) };
  scene.interface = state.drives.flatMap((drive, at) => {
    const own = read[at].length < asked.length ? { frequencies: hertz(read[at]) } : {};
    const { frequencies: _, ...wired } = scene.interface[drive];
    return read[at].length ? [{ ...wired, ...own }] : [];
  });
  for (const name of ["magnitude_accuracy", "phase_accuracy", "magnitude_noise", "phase_noise"]) {
    if (scene.readout?.[name]) scene.readout[name] *= state.noise;
  }
  const how = `# rcskin sweep THIS.toml --press '${pressText(state.touches)}' -o out.csv\n`;
  return how + table(scene, "");
}

/** Table as text: its own values first, then its tables. @param {any} values @param {string} path @returns {string} */
function table(values, path) {
  const isTable = (/** @type {any} */ value) =>
    value !== null && typeof value === "object" && !Array.isArray(value);
  const ofTables = (/** @type {any} */ value) =>
    Array.isArray(value) && value.length > 0 && value.every(isTable);
  const entries = Object.entries(values);
  const own = entries
    .filter(([, value]) => !isTable(value) && !ofTables(value))
    .map(([key, value]) => `${key} = ${literal(value)}\n`);
  const within = entries.flatMap(([key, value]) => {
    const name = path ? `${path}.${key}` : key;
    if (isTable(value)) return [`\n[${name}]\n${table(value, name)}`];
    return ofTables(value)
      ? value.map((/** @type {any} */ each) => `\n[[${name}]]\n${table(each, name)}`)
      : [];
  });
  return [...own, ...within].join("");
}

/** @param {any} value @returns {string} */
function literal(value) {
  if (Array.isArray(value)) return `[${value.map(literal).join(", ")}]`;
  return JSON.stringify(value);
}

/** @param {number} value */
function short(value) {
  return Number(value.toPrecision(6)).toString();
}

/** @param {string} text */
function quoted(text) {
  return /[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

/** Offers a text for saving. @param {string} name @param {string} text */
export function save(name, text) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([text], { type: "text/plain" }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}
