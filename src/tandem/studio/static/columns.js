/**
 * The columns of the task table: how a task's field reads as the text of a cell, and how a text
 * becomes the field. A text that makes no sense is kept as it is, so that the check says what is wrong
 * with it.
 * @module
 */
import { shown, t } from "./words.js";

/** @typedef {import("./ordered.js").Cell} Cell */
/** @typedef {import("./ordered.js").Task} Task */
/** @typedef {{id: string, title: string, hint: string, kind: "name" | "number" | "list" | "text" | "data", read: (task: Task) => string, write: (task: Task, text: string) => Task}} Column */

/** Fields that a table shows only where a task has them, or where they were asked for. */
export const FURTHER = /** @type {const} */ (["label", "part", "tool", "zone", "place", "release", "deadline", "spread", "together", "difficulty", "wait", "ergonomics"]);
/** @type {Record<string, "number" | "text" | "data">} */
const KINDS = { release: "number", deadline: "number", spread: "data", together: "data", difficulty: "data", wait: "data", ergonomics: "data" };

/** @param {string} text @returns {unknown} a number where it is one, with a point or a comma. */
export function numberOr(text) {
  const plain = text.trim().replace(/^([+-]?\d+),(\d+)$/, "$1.$2");
  return plain !== "" && Number.isFinite(Number(plain)) ? Number(plain) : text.trim();
}

/** @param {Task} task @param {string} key @param {unknown} value empty: without the key. @returns {Task} */
function withField(task, key, value) {
  const { [key]: _, ...rest } = task;
  return /** @type {Task} */ (value === undefined || value === "" ? rest : key in task ? { ...task, [key]: value } : { ...rest, [key]: value });
}

/** What each one has, as one writes it by hand: "anna: 2; ben: 3.5", "peak:reba: 7". */
const EACH = /^\s*[^;{}[\]"]+:[^:;{}[\]"]+(;[^;{}[\]"]+:[^:;{}[\]"]+)*;?\s*$/;

/** @param {unknown} value @returns {string} a value as one writes it by hand. */
export function plain(value) {
  if (value === undefined || value === null) return "";
  if (typeof value !== "object") return shown(value);
  const each = Object.entries(value).map(([name, one]) => `${name}: ${typeof one === "object" ? "{}" : shown(one)}`).join("; ");
  return !Array.isArray(value) && EACH.test(each) ? each : JSON.stringify(value);
}

/** @param {string} text @returns {unknown} what each one has, or JSON where it is some, else a number or the text. */
export function dataOr(text) {
  if (EACH.test(text)) {
    const each = text.split(";").filter((one) => one.trim());
    return Object.fromEntries(each.map((one) => [one.slice(0, one.lastIndexOf(":")).trim(), numberOr(one.slice(one.lastIndexOf(":") + 1))]));
  }
  if (/^\s*[[{]/.test(text)) {
    try {
      return JSON.parse(text);
    } catch {
      return text;
    }
  }
  return numberOr(text);
}

/** @param {string} text @returns {string[]} */
export const listOf = (text) => text.split(/[,;]/).map((one) => one.trim()).filter(Boolean);

/** @param {string} key @param {"number" | "text" | "data"} kind @returns {Column} */
function field(key, kind) {
  const parse = { number: numberOr, data: dataOr, text: (/** @type {string} */ text) => text.trim() }[kind];
  return {
    id: key,
    title: t(`column.${key}`),
    hint: t(`hint.${key}`),
    kind,
    read: (task) => plain(task[key]),
    write: (task, text) => withField(task, key, parse(text)),
  };
}

/** @param {string} operator @param {string} label @returns {Column} */
function time(operator, label) {
  return {
    id: `time/${operator}`,
    title: t("column.time", { operator: label }),
    hint: t("hint.time", { operator: label }),
    kind: "number",
    read: (task) => plain(task.time?.[operator]),
    write: (task, text) => {
      const { [operator]: _, ...others } = task.time ?? {};
      const value = numberOr(text);
      return { ...task, time: value === "" ? others : { ...task.time, [operator]: value } };
    },
  };
}

/**
 * @param {Cell} cell
 * @param {readonly string[]} asked further fields to show even where no task has them.
 * @returns {Column[]}
 */
export function columnsOf(cell, asked) {
  const used = FURTHER.filter((key) => asked.includes(key) || cell.tasks.some((task) => key in task));
  const [words, rest] = [used.filter((key) => key === "label" || key === "part"), used.filter((key) => key !== "label" && key !== "part")];
  return [
    { id: "name", title: t("column.name"), hint: t("hint.name"), kind: "name", read: (task) => task.name, write: (task, text) => ({ ...task, name: text.trim() }) },
    ...words.map((key) => field(key, "text")),
    ...cell.operators.map((operator) => time(operator.name, String(operator.label ?? operator.name))),
    field("stress", "data"),
    {
      id: "after",
      title: t("column.after"),
      hint: t("hint.after"),
      kind: "list",
      read: (task) => (Array.isArray(task.after) ? task.after.join(", ") : plain(task.after)),
      write: (task, text) => withField(task, "after", listOf(text).length ? listOf(text) : ""),
    },
    ...rest.map((key) => field(key, KINDS[key] ?? "text")),
  ];
}

/**
 * Writes one text; a new name is followed wherever the old one stood.
 * @param {Cell} cell @param {number} row @param {Column} column @param {string} text
 * @returns {Cell}
 */
export function write(cell, row, column, text) {
  const old = cell.tasks[row];
  if (column.read(old) === text) return cell;
  const tasks = cell.tasks.map((task, place) => (place === row ? column.write(task, text) : task));
  if (column.id !== "name") return { ...cell, tasks };
  return renamed({ ...cell, tasks }, old.name, text.trim());
}

/** @param {Cell} cell @param {string} from @param {string} to @returns {Cell} */
function renamed(cell, from, to) {
  if (from === "" || to === "") return cell;
  const follow = (/** @type {unknown} */ names) => (Array.isArray(names) ? names.map((name) => (name === from ? to : name)) : names);
  const tasks = cell.tasks.map((task) => {
    const moved = (/** @type {any} */ one) => (one?.after === from ? { ...one, after: to } : one);
    const wait = Array.isArray(task.wait) ? task.wait.map(moved) : moved(task.wait);
    return /** @type {Task} */ ({ ...task, ...("after" in task && { after: follow(task.after) }), ...("wait" in task && { wait }) });
  });
  const together = Array.isArray(cell.same_operator) ? { same_operator: cell.same_operator.map(follow) } : {};
  return { ...cell, tasks, ...together };
}

/** @param {Cell} cell @returns {Task} a task with the next free number for its name. */
export function newTask(cell) {
  const names = new Set(cell.tasks.map((task) => task.name));
  let number = cell.tasks.length + 1;
  while (names.has(String(number))) number += 1;
  return { name: String(number), time: {} };
}

/**
 * The column and row at which a fault of the check is to be shown.
 * @param {string[]} place
 * @param {Column[]} columns
 * @param {Map<string, number>} rows
 * @returns {{row: number, column: number} | null} null where it is no task's.
 */
export function cellOf(place, columns, rows) {
  if (place[0] !== "tasks" || place.length < 2) return null;
  const row = place[2] === "" ? Number(place[3]) : rows.get(String(place[1]));
  if (row === undefined) return null;
  const exact = columns.findIndex((column) => column.id === `${place[2]}/${place[3]}`);
  const column = exact >= 0 ? exact : columns.findIndex((column) => column.id === place[2]);
  return { row, column: Math.max(column, 0) };
}
