/**
 * The page's words in the language of the reader, and its numbers.
 * @module
 */
import { signal } from "./view.js";

const KEPT = "tandem.language";
export const LANGUAGES = /** @type {const} */ (["en", "de"]);

/** The language of the page. */
export const language = signal(remembered());
/** @type {Record<string, Record<string, string>>} */
const words = {};

function remembered() {
  const kept = localStorage.getItem(KEPT) ?? navigator.language.slice(0, 2);
  return kept === "de" ? "de" : "en";
}

/** Reads both languages, so that changing the language asks for nothing. */
export async function loadWords() {
  await Promise.all(
    LANGUAGES.map(async (name) => {
      const answer = await fetch(new URL(`./words_${name}.json`, import.meta.url));
      words[name] = await answer.json();
    }),
  );
  document.documentElement.lang = language.value;
}

/** @param {string} name */
export function speak(name) {
  localStorage.setItem(KEPT, name);
  document.documentElement.lang = name;
  language.value = name;
}

/**
 * The sentence of a key; `{n}` in it is what `values` holds, numbers as the language writes them.
 * @param {string} key
 * @param {Record<string, unknown>} [values]
 */
export function t(key, values = {}) {
  const sentence = words[language.value]?.[key];
  if (sentence === undefined) throw new Error(`no word for ${key} in ${language.value}`);
  return sentence.replace(/\{(\w+)\}/g, (_, name) => shown(values[name]));
}

/** @param {unknown} value a number as the language writes it, anything else as it is. */
export function shown(value) {
  if (typeof value !== "number") return String(value);
  const text = String(Math.round(value * 1000) / 1000);
  return language.value === "de" ? text.replace(".", ",") : text;
}
