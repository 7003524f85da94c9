/**
 * Cells between their JSON document and the form that the page edits. JavaScript sorts keys that look
 * like whole numbers, so that the tasks "10" and "9" would change places; the page keeps tasks and
 * operators as lists, and reads and writes the document with such keys marked.
 * @module
 */

/** @typedef {{name: string, time?: Record<string, unknown>, stress?: unknown, after?: unknown, [key: string]: unknown}} Task */
/** @typedef {{name: string, kind?: string, label?: string, [key: string]: unknown}} Operator */
/** @typedef {{operators: Operator[], tasks: Task[], [key: string]: unknown}} Cell */

const MARK = "\u0001";
// A quote before digits and `":` begins a key unless it is itself escaped.
const NUMERIC_KEY = /(?<!\\)"(\d+)"(?=\s*:)/g;
const MARKED_KEY = /"\\u0001(\d+)"(?=:)/g;

/**
 * The value of a JSON text, with objects' whole-number keys marked so that they keep their order.
 * @param {string} text
 * @returns {any}
 */
const marked = (text) => JSON.parse(text.replace(NUMERIC_KEY, `"\\u0001$1"`));

/** @param {string} key */
const bare = (key) => (key.startsWith(MARK) ? key.slice(1) : key);

/** @param {unknown} value @returns {any} the value with its keys unmarked. */
function unmarked(value) {
  if (Array.isArray(value)) return value.map(unmarked);
  if (value === null || typeof value !== "object") return value;
  return Object.fromEntries(Object.entries(value).map(([key, held]) => [bare(key), unmarked(held)]));
}

/** @param {Record<string, object> | undefined} named @returns {any[]} */
const listed = (named) =>
  Object.entries(named ?? {}).map(([name, held]) => ({ name: bare(name), ...unmarked(held) }));

/**
 * The document of an answer in which `cell` is a cell, with the cell in the page's form.
 * @param {string} text
 * @returns {any}
 */
export function readAnswer(text) {
  const plain = JSON.parse(text);
  if (plain === null || typeof plain !== "object" || !plain.cell?.tasks) return plain;
  const inOrder = marked(text);
  const draft = plain.draft?.cell?.tasks ? { draft: { ...plain.draft, cell: edited(plain.draft.cell, inOrder.draft.cell) } } : {};
  return { ...plain, cell: edited(plain.cell, inOrder.cell), ...draft };
}

/** @param {any} document @param {any} inOrder the same with its keys marked. @returns {Cell} */
const edited = (document, inOrder) => ({ ...document, operators: listed(inOrder.operators), tasks: listed(inOrder.tasks) });

/** @param {{name: string}[]} list */
const named = (list) =>
  Object.fromEntries(list.map(({ name, ...held }) => [/^\d+$/.test(name) ? MARK + name : name, held]));

/**
 * A request's JSON text; a `cell` in it, and an `other`, is written as the document of a cell file.
 * @param {Record<string, any>} body
 */
export function writeRequest(body) {
  const written = Object.fromEntries(["cell", "other"].filter((key) => body[key]).map((key) => [key, documentOf(body[key])]));
  const text = JSON.stringify({ ...body, ...written });
  return body.cell ? text.replace(MARKED_KEY, '"$1"') : text;
}

/** @param {Cell} cell */
const documentOf = (cell) => ({ ...cell, operators: named(cell.operators), tasks: named(cell.tasks) });

/** @param {Cell} cell @returns {string} a text that is equal for equal cells. */
export const textOf = (cell) => JSON.stringify(cell);
