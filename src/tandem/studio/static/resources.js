/**
 * The panels for everything of the cell that is neither task nor operator: tools, zones, places,
 * walks, variants, cost and rules. A tool or a zone that only tasks name stands there too, so that it
 * can be given what is special about it.
 * @module
 */
import { Entry, withKey } from "./fields.js";
import { cell, edit, faults } from "./state.js";
import { t } from "./words.js";
import { html, observed, signal } from "./view.js";

/** @typedef {import("./ordered.js").Cell} Cell */
/** @typedef {keyof typeof import("./fields.js").KINDS} KindName */
/** @typedef {{key: string, fields: Record<string, KindName>, whole?: KindName, named?: (cell: Cell) => unknown[], fixed?: boolean}} Group entries by name: the fields of each, or what its whole value is; names that other keys of the cell use; whether only these can be there. */

/** @param {Cell} cell @param {string} key @returns {unknown[]} the names under a key of tasks, joint ways and operators. */
const namesOf = (cell, key) =>
  [...cell.operators, ...cell.tasks, ...cell.tasks.flatMap((task) => (Array.isArray(task.together) ? task.together : []))].flatMap((one) => {
    const value = one?.[key];
    return value !== null && typeof value === "object" ? Object.values(value) : [value];
  });

/** @type {Group[]} */
const GROUPS = [
  { key: "tools", fields: { capacity: "number", changeover: "data" }, named: (cell) => namesOf(cell, "tool") },
  { key: "zones", fields: { capacity: "number", apart: "names" }, named: (cell) => namesOf(cell, "zone") },
  { key: "places", fields: {}, whole: "point", named: (cell) => namesOf(cell, "place") },
  { key: "walk", fields: {}, whole: "data", named: (cell) => cell.operators.map((one) => one.name), fixed: true },
  { key: "variants", fields: { share: "number", tasks: "data" } },
];
/** Keys of the cell that are one value. @type {Record<string, KindName>} */
const RULES = { name: "text", same_operator: "pairs", stress_of_set: "data", cycles_per_shift: "number" };
/** @type {Record<string, KindName>} */
const COST = { operators: "data", station: "number", invest: "number", hours: "number" };

/** @param {string} key @returns {Record<string, any>} what the cell has under the key, name to value. */
function heldIn(key) {
  const held = cell.value[key];
  return held !== null && typeof held === "object" && !Array.isArray(held) ? held : {};
}

/** @param {string} key @param {Record<string, any>} held empty: the cell is without the key. */
const put = (key, held) => edit((now) => /** @type {Cell} */ (withKey(now, key, Object.keys(held).length ? held : "")));

/** @param {string} key @param {string} name @param {unknown} value empty: without the entry. */
const setEntry = (key, name, value) => put(key, withKey(heldIn(key), name, value));

/** @param {Group} group @returns {string[]} those that the cell describes, then those that it only names. */
function namesIn(group) {
  const named = (group.named?.(cell.value) ?? []).filter((name) => typeof name === "string" || typeof name === "number");
  return [...new Set([...Object.keys(heldIn(group.key)), ...named.map(String)])];
}

export const Resources = observed(() => html`
  <div class="heading"><h2>${t("resources.title")}</h2></div>
  ${GROUPS.map((group) => html`<${Panel} key=${group.key} group=${group} />`)}
  <${Record} name="cost" fields=${COST} />
  <${Record} name="rules" fields=${RULES} />
`);

/** @param {string} key @returns {boolean} whether something under it is wrong. */
const isWrong = (key) => faults.value.some((fault) => String(fault.place[0]) === key);

const Panel = observed((/** @type {{group: Group}} */ { group }) => {
  const { key, fields, whole } = group;
  const names = namesIn(group);
  const keys = whole ? [""] : Object.keys(fields);
  return html`<details class="panel operators ${isWrong(key) ? "wrong" : ""}">
    <summary>${t(`${key}.title`)} <span class="faint">${t("resources.count", { n: group.fixed ? Object.keys(heldIn(key)).length : names.length })}</span></summary>
    <p class="hint">${t(`${key}.hint`)}</p>
    <div class="sheet"><table aria-label=${t(`${key}.title`)}>
      <thead><tr><th scope="col">${t("resources.name")}</th>${keys.map((field) => html`<th scope="col">${t(`${key}.${field || "value"}`)}</th>`)}<th></th></tr></thead>
      <tbody>
        ${names.map((name) => html`<${Row} key=${name} group=${group} name=${name} held=${heldIn(key)[name]} />`)}
        ${group.fixed ? null : html`<tr><td colspan=${keys.length + 2}><${Add} group=${group} /></td></tr>`}
      </tbody>
    </table></div>
  </details>`;
});

const Row = observed((/** @type {{group: Group, name: string, held: any}} */ { group, name, held }) => {
  const { key, fields, whole } = group;
  const isThere = held !== undefined;
  return html`<tr>
    <th scope="row">${name}</th>
    ${whole
      ? html`<${Entry} place=${[key, name]} kind=${whole} value=${held} label=${label(key, "value", name)} hint=${t(`hint.${key}.value`)}
          set=${(/** @type {unknown} */ value) => setEntry(key, name, value)} />`
      : Object.entries(fields).map(([field, kind]) => html`<${Entry} key=${field} place=${[key, name, field]} kind=${kind} value=${held?.[field]} label=${label(key, field, name)} hint=${t(`hint.${key}.${field}`)}
          set=${(/** @type {unknown} */ value) => setEntry(key, name, withKey(held ?? {}, field, value))} />`)}
    <td>${isThere ? html`<button onClick=${() => setEntry(key, name, "")} aria-label=${t("operators.remove", { name })}>✕</button>` : null}</td>
  </tr>`;
});

/** @param {string} key @param {string} field @param {string} name */
const label = (key, field, name) => t("operators.field", { field: t(`${key}.${field}`), name });

/** What is about to be added, by group. */
const added = signal(/** @type {Record<string, string>} */ ({}));

const Add = observed((/** @type {{group: Group}} */ { group }) => {
  const { key, whole } = group;
  const text = added.value[key] ?? "";
  /** @param {Event} event */
  const add = (event) => {
    event.preventDefault();
    const name = text.trim();
    if (name === "" || name in heldIn(key)) return;
    setEntry(key, name, whole === "point" ? [0, 0] : {});
    added.value = { ...added.value, [key]: "" };
  };
  return html`<form onSubmit=${add}>
    <input aria-label=${t(`${key}.new`)} placeholder=${t(`${key}.new`)} value=${text} onInput=${(/** @type {any} */ event) => (added.value = { ...added.value, [key]: event.currentTarget.value })} />
    <button disabled=${text.trim() === ""}>${t("resources.add")}</button>
  </form>`;
});

/** Keys that are there once: those of the cost, or those of the cell itself. */
const Record = observed((/** @type {{name: "cost" | "rules", fields: Record<string, KindName>}} */ { name, fields }) => {
  const isPart = name === "cost";
  const held = isPart ? heldIn(name) : cell.value;
  /** @param {string} field @param {unknown} value */
  const set = (field, value) => (isPart ? put(name, withKey(held, field, value)) : edit((now) => /** @type {Cell} */ (withKey(now, field, value))));
  const wrong = isPart ? isWrong(name) : Object.keys(fields).some(isWrong);
  return html`<details class="panel operators ${wrong ? "wrong" : ""}">
    <summary>${t(`${name}.title`)}</summary>
    <p class="hint">${t(`${name}.hint`)}</p>
    <div class="sheet"><table aria-label=${t(`${name}.title`)}><tbody>
      ${Object.entries(fields).map(([field, kind]) => html`<tr key=${field}>
        <th scope="row">${t(`${name}.${field}`)}</th>
        <${Entry} place=${isPart ? [name, field] : [field]} kind=${kind} value=${held[field]} label=${t(`${name}.${field}`)} hint=${t(`hint.${name}.${field}`)}
          set=${(/** @type {unknown} */ value) => set(field, value)} />
      </tr>`)}
    </tbody></table></div>
  </details>`;
});
