/**
 * The operators: who is there, of which kind, with breaks and setup, what they hold at the start and
 * how much stress they may bear.
 * @module
 */
import { Entry, withKey } from "./fields.js";
import { looksOf } from "./looks.js";
import { at } from "./problems.js";
import { cell, edit } from "./state.js";
import { t } from "./words.js";
import { html, observed, signal } from "./view.js";

/** @typedef {import("./ordered.js").Operator} Operator */

const KINDS = ["human", "robot", "machine"];
/** Keys of an operator beside its kind. */
const FIELDS = /** @type {const} */ ({ label: "text", breaks: "spans", setup: "number", stress_limit: "number", limits: "data", tool: "text", place: "text", holds: "pairs" });
const KEYS = /** @type {(keyof typeof FIELDS)[]} */ (Object.keys(FIELDS));

/** The name of the operator that is about to be added. */
const added = signal("");

/** @param {string} name @param {string} key @param {unknown} value empty: without the key. */
const set = (name, key, value) =>
  edit((now) => ({ ...now, operators: now.operators.map((operator) => (operator.name === name ? withKey(operator, key, value) : operator)) }));

function add() {
  const name = added.value.trim();
  if (name === "" || cell.value.operators.some((operator) => operator.name === name)) return;
  edit((now) => ({ ...now, operators: [...now.operators, { name, kind: "human" }] }));
  added.value = "";
}

/** Takes an operator away, with the times that tasks have for it. @param {string} name */
function remove(name) {
  edit((now) => ({
    ...now,
    operators: now.operators.filter((operator) => operator.name !== name),
    tasks: now.tasks.map((task) => {
      if (!task.time || !(name in task.time)) return task;
      const { [name]: _, ...time } = task.time;
      return { ...task, time };
    }),
  }));
}

export const Operators = observed(() => {
  const looks = looksOf(cell.value);
  return html`
    <div class="heading"><h2>${t("operators.title")}</h2></div>
    <div class="sheet operators">
      <table aria-label=${t("operators.title")}>
        <thead><tr>${["name", "kind", ...KEYS].map((key) => html`<th scope="col">${t(`operators.${key}`)}</th>`)}<th></th></tr></thead>
        <tbody>
          ${cell.value.operators.map((operator) => html`<${One} key=${operator.name} operator=${operator} look=${looks.get(operator.name)?.class} />`)}
          <tr>
            <td colspan=${KEYS.length + 3}><form onSubmit=${(/** @type {Event} */ event) => (event.preventDefault(), add())}>
              <input aria-label=${t("operators.new")} placeholder=${t("operators.new")} value=${added.value} onInput=${(/** @type {any} */ event) => (added.value = event.currentTarget.value)} />
              <button disabled=${added.value.trim() === ""}>${t("operators.add")}</button>
            </form></td>
          </tr>
        </tbody>
      </table>
    </div>
  `;
});

const One = observed((/** @type {{operator: Operator, look: string}} */ { operator, look }) => {
  const { name } = operator;
  const kind = operator.kind ?? "human";
  return html`<tr>
    <th scope="row"><span class="swatch ${look}" aria-hidden="true"></span> ${name}</th>
    <td><button data-at=${at("operators", name, "kind")} onClick=${() => set(name, "kind", KINDS[(KINDS.indexOf(kind) + 1) % KINDS.length])} aria-label=${t("operators.change_kind", { name, kind: t(`kind.${kind}`) })}>${t(`kind.${kind}`)}</button></td>
    ${KEYS.map((key) => html`<${Entry} key=${key}
      place=${["operators", name, key]}
      kind=${FIELDS[key]}
      value=${operator[key]}
      label=${t("operators.field", { field: t(`operators.${key}`), name })}
      hint=${t(`hint.operators.${key}`)}
      set=${(/** @type {unknown} */ value) => set(name, key, value)}
    />`)}
    <td><button onClick=${() => remove(name)} aria-label=${t("operators.remove", { name })}>✕</button></td>
  </tr>`;
});
