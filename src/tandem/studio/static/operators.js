/**
 * The operators: who is there, of which kind, with which breaks and how much stress they may bear.
 * @module
 */
import { numberOr } from "./columns.js";
import { looksOf } from "./looks.js";
import { cell, edit, faults } from "./state.js";
import { t } from "./words.js";
import { Field, html, observed, signal } from "./view.js";

/** @typedef {import("./ordered.js").Operator} Operator */

const KINDS = ["human", "robot", "machine"];

/** The name of the operator that is about to be added. */
const added = signal("");

/** @param {string} name @param {string} key @param {unknown} value empty: without the key. */
function set(name, key, value) {
  edit((now) => ({
    ...now,
    operators: now.operators.map((operator) => {
      if (operator.name !== name) return operator;
      const { [key]: _, ...rest } = operator;
      return /** @type {Operator} */ (value === "" ? rest : { ...operator, [key]: value });
    }),
  }));
}

/** @param {unknown} breaks @returns {string} "90-120, 150-160". */
const breaksAsText = (breaks) => (Array.isArray(breaks) ? breaks.map((one) => (Array.isArray(one) ? one.join("-") : String(one))).join(", ") : String(breaks ?? ""));

/** @param {string} text @returns {unknown} pairs of seconds; what is none is kept as it is, so that the check says so. */
function breaksOf(text) {
  if (text.trim() === "") return "";
  const pairs = text.split(/[,;]/).map((one) => /^\s*(\d+(?:\.\d+)?)\s*[-–]\s*(\d+(?:\.\d+)?)\s*$/.exec(one));
  return pairs.every(Boolean) ? pairs.map((one) => [Number(one?.[1]), Number(one?.[2])]) : text;
}

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
        <thead><tr>${["name", "kind", "label", "breaks", "stress_limit"].map((key) => html`<th scope="col">${t(`operators.${key}`)}</th>`)}<th></th></tr></thead>
        <tbody>
          ${cell.value.operators.map((operator) => html`<${One} key=${operator.name} operator=${operator} look=${looks.get(operator.name)?.class} />`)}
          <tr>
            <td colspan="6"><form onSubmit=${(/** @type {Event} */ event) => (event.preventDefault(), add())}>
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
  /** @param {string} key @param {string} text @param {(text: string) => unknown} parse */
  const field = (key, text, parse) => {
    const wrong = faults.value.find((fault) => fault.place[0] === "operators" && fault.place[1] === name && fault.place[2] === key);
    return html`<td class=${wrong ? "wrong" : ""}><${Field}
      aria-label=${t("operators.field", { field: t(`operators.${key}`), name })}
      aria-invalid=${wrong ? "true" : undefined}
      title=${wrong?.message ?? ""}
      value=${text}
      commit=${(/** @type {string} */ typed) => set(name, key, parse(typed))}
    /></td>`;
  };
  const kind = operator.kind ?? "human";
  return html`<tr>
    <th scope="row"><span class="swatch ${look}" aria-hidden="true"></span> ${name}</th>
    <td><button onClick=${() => set(name, "kind", KINDS[(KINDS.indexOf(kind) + 1) % KINDS.length])} aria-label=${t("operators.change_kind", { name, kind: t(`kind.${kind}`) })}>${t(`kind.${kind}`)}</button></td>
    ${field("label", String(operator.label ?? ""), (text) => text.trim())}
    ${field("breaks", breaksAsText(operator.breaks), breaksOf)}
    ${field("stress_limit", operator.stress_limit === undefined ? "" : String(operator.stress_limit), numberOr)}
    <td><button onClick=${() => remove(name)} aria-label=${t("operators.remove", { name })}>✕</button></td>
  </tr>`;
});
