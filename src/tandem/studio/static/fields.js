/**
 * The fields of the panels: how a key of the cell reads as text, and how a text becomes the key's
 * value. A text that makes no sense is kept as it is, so that the check says what is wrong with it.
 * What is wrong is said at its field.
 * @module
 */
import { dataOr, listOf, numberOr, plain } from "./columns.js";
import { at } from "./problems.js";
import { faults } from "./state.js";
import { Field, html, observed } from "./view.js";

/** @typedef {{read: (value: unknown) => string, write: (text: string) => unknown}} Kind how a value reads, and what a text means; "" where it means none. */

const NUMBERS = /^\s*(-?\d+(?:\.\d+)?)\s*[-–]\s*(\d+(?:\.\d+)?)\s*$/;

/** @param {unknown} value @param {string} between @param {string} joint @returns {string} lists of lists with two marks between. */
const nested = (value, between, joint) =>
  Array.isArray(value) ? value.map((one) => (Array.isArray(one) ? one.join(joint) : String(one))).join(between) : plain(value);

/** @type {Record<"text" | "number" | "data" | "names" | "spans" | "pairs" | "point", Kind>} */
export const KINDS = {
  text: { read: plain, write: (text) => text.trim() },
  number: { read: plain, write: numberOr },
  data: { read: plain, write: dataOr },
  names: { read: (value) => (Array.isArray(value) ? value.join(", ") : plain(value)), write: (text) => (listOf(text).length ? listOf(text) : "") },
  // "90-120, 150-160"
  spans: {
    read: (value) => nested(value, ", ", "-"),
    write: (text) => {
      if (text.trim() === "") return "";
      const spans = text.split(/[,;]/).map((one) => NUMBERS.exec(one));
      return spans.every(Boolean) ? spans.map((one) => [Number(one?.[1]), Number(one?.[2])]) : text;
    },
  },
  // "load + unload; cut + bore"
  pairs: {
    read: (value) => nested(value, "; ", " + "),
    write: (text) => {
      const pairs = text.split(";").filter((one) => one.trim()).map((one) => one.split("+").map((name) => name.trim()));
      return pairs.length ? pairs : "";
    },
  },
  // "2.5; 1"
  point: {
    read: (value) => (Array.isArray(value) ? value.join("; ") : plain(value)),
    write: (text) => (text.trim() === "" ? "" : text.split(";").map(numberOr)),
  },
};

/** @param {Record<string, any>} held @param {string} key @param {unknown} value empty: without the key. @returns {any} */
export function withKey(held, key, value) {
  const { [key]: _, ...rest } = held;
  return value === "" ? rest : { ...held, [key]: value };
}

/** @param {string[]} place @returns {string[]} what is said of a place of the cell and of all below it. */
const messagesAt = (place) => faults.value.filter((fault) => place.every((step, depth) => String(fault.place[depth]) === step)).map((fault) => fault.message);

/**
 * A field of a table in a panel, with what is wrong with it.
 * @param {{place: string[], kind: keyof typeof KINDS, value: unknown, label: string, hint?: string, set: (value: unknown) => void}} props
 */
export const Entry = observed((/** @type {{place: string[], kind: keyof typeof KINDS, value: unknown, label: string, hint?: string, set: (value: unknown) => void}} */ props) => {
  const { place, kind, value, label, hint, set } = props;
  const wrong = messagesAt(place).join("\n");
  const id = `fault-${place.join("-")}`;
  return html`<td class=${wrong ? "wrong" : ""}><${Field}
      aria-label=${label}
      aria-invalid=${wrong ? "true" : undefined}
      aria-describedby=${wrong ? id : undefined}
      data-at=${at(...place)}
      title=${hint ?? ""}
      placeholder=${hint && value === undefined ? "–" : ""}
      spellcheck=${false}
      value=${KINDS[kind].read(value)}
      commit=${(/** @type {string} */ text) => set(KINDS[kind].write(text))}
    />${wrong ? html`<span class="message" id=${id}>${wrong}</span>` : null}</td>`;
});
